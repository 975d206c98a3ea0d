//! Draws creature files without checking them: `cargo run -p graph --example look -- FILE... > x.svg`.

use ipc::wiring::Source;
use ipc::wiring::sketch::sketch;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut sketches = Vec::new();
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path)?;
        sketches.push(sketch(&Source::new(path, text), None));
    }
    let model = graph::of_sketches(&sketches);
    print!("{}", graph::svg(&graph::draw(&model), graph::Dress::File));
    Ok(())
}
