//! An evaluation never allocates, however far it backs up.

mod stage;

use stage::{Switches, running};

#[test]
fn an_evaluation_does_not_allocate() {
    let mut program = String::new();
    for branch in 0..10 {
        program += &format!(
            "rm b{branch} reports to top. add stimulus a to rm b{branch} with magnitude {branch}.\n"
        );
        for leaf in 0..10 {
            let name = format!("l{branch}x{leaf}");
            program += &format!(
                "rm {name} reports to rm b{branch}. add stimulus always to rm {name} with magnitude {}. mcu m reports \
                 to rm {name}. rm {name} selects goal p.\n",
                leaf + 1
            );
        }
    }
    let mut creature = running(&program);
    let mut senses = Switches::default();
    senses.set("a", 1.0);
    let hierarchy = creature.hierarchy_mut();
    let mut asked = 0;
    let counted = allocation_counter::measure(|| asked = hierarchy.evaluate(&senses).asked);
    assert_eq!(
        asked, 101,
        "nine branches with ten leaves each, and the top level, were tried"
    );
    assert_eq!(counted.count_total, 0);
}
