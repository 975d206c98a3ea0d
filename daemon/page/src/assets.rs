//! The files of the page, carried inside the binary. Nothing is fetched from anywhere else.

/// One file of the page.
pub(crate) struct Asset {
    /// Where a browser asks for it.
    pub(crate) path: &'static str,
    /// Its media type.
    pub(crate) media: &'static str,
    /// Its text.
    pub(crate) text: &'static str,
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! asset {
    ($path:literal, $media:expr, $file:literal) => {
        Asset {
            path: $path,
            media: $media,
            text: include_str!(concat!("../assets/", $file)),
        }
    };
}

/// Every file of the page.
static ASSETS: &[Asset] = &[
    asset!("/", "text/html; charset=utf-8", "index.html"),
    asset!("/style.css", "text/css; charset=utf-8", "style.css"),
    asset!("/wiring.css", "text/css; charset=utf-8", "wiring.css"),
    asset!("/nest.css", "text/css; charset=utf-8", "nest.css"),
    asset!("/icon.svg", "image/svg+xml", "icon.svg"),
    asset!("/main.js", SCRIPT, "main.js"),
    asset!("/daemon.js", SCRIPT, "daemon.js"),
    asset!("/words.js", SCRIPT, "words.js"),
    asset!("/halt.js", SCRIPT, "halt.js"),
    asset!("/world.js", SCRIPT, "world.js"),
    asset!("/worlds.js", SCRIPT, "worlds.js"),
    asset!("/floor.js", SCRIPT, "floor.js"),
    asset!("/ootland.css", "text/css; charset=utf-8", "ootland.css"),
    asset!("/ootland.js", SCRIPT, "ootland.js"),
    asset!("/ootland_curve.js", SCRIPT, "ootland_curve.js"),
    asset!("/ootland_shape.js", SCRIPT, "ootland_shape.js"),
    asset!("/ootland_map.js", SCRIPT, "ootland_map.js"),
    asset!("/wiring.js", SCRIPT, "wiring.js"),
    asset!("/hierarchy.js", SCRIPT, "hierarchy.js"),
    asset!("/holders.js", SCRIPT, "holders.js"),
    asset!("/nest.js", SCRIPT, "nest.js"),
    asset!("/pulses.js", SCRIPT, "pulses.js"),
    asset!("/views.js", SCRIPT, "views.js"),
    asset!("/timeline.js", SCRIPT, "timeline.js"),
    asset!("/wire.js", SCRIPT, "wire.js"),
    asset!("/wires.js", SCRIPT, "wires.js"),
    asset!("/latency.js", SCRIPT, "latency.js"),
    asset!("/events.js", SCRIPT, "events.js"),
];

/// The file that a browser asks for at `path`.
pub(crate) fn find(path: &str) -> Option<&'static Asset> {
    ASSETS.iter().find(|asset| asset.path == path)
}
