//! Creature files as models, unchecked: a picture is made of what a file names.

use graph::Model;
use ipc::wiring::Source;
use ipc::wiring::sketch::sketch;

/// The model of a creature file and of manifests that add to it.
pub(crate) fn read(texts: &[&str]) -> Model {
    let sketches: Vec<_> = texts
        .iter()
        .map(|text| sketch(&Source::new("test.toml", *text), None))
        .collect();
    graph::of_sketches(&sketches)
}

/// Allen with so many levels.
pub(crate) fn allen(levels: usize) -> Model {
    let files = [
        include_str!("../../../../layers/allen/allen.toml"),
        include_str!("../../../../layers/allen/wander.toml"),
        include_str!("explore.toml"),
    ];
    read(&files[..levels])
}
