//! The `truckin` command.
use truckin::ootland::*;
fn main() {
    let world = World::default();
    for (trucks, slots, games) in [(1usize, 5000u32, 200u64), (20, 5000, 40)] {
        let all = truckin::strategies::all_chromosomes();
        let t = std::time::Instant::now();
        let mut best = vec![];
        for g in 0..games {
            let mut ch = Chance::new(7, g);
            let cs: Vec<_> = (0..trucks).map(|_| all[ch.below(625) as usize]).collect();
            let mut game = Game::new(&world, &cs, slots, 1, g);
            game.play(false).unwrap();
            for s in game.standings() { best.push((s.profit_cents, cs[s.seat])); }
        }
        let s = t.elapsed().as_secs_f64();
        println!("{trucks} x {slots}: {:.2} M truck-slots/s", (trucks as f64 * slots as f64 * games as f64) / s / 1e6);
        best.sort();
        for b in best.iter().rev().take(12) { println!("{} {}", b.1, b.0 / 100); }
        println!("median {}", best[best.len()/2].0/100);
    }
}
