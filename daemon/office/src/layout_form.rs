//! The form of a layout's text: its tables and keys, as `layout_text` explains them.
//!
//! Must never judge a value: that is done in `layout_text`.

use crate::layout::Surface;
use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawLayout {
    pub(crate) name: String,
    pub(crate) size: Spanned<[f64; 2]>,
    pub(crate) start: Spanned<[f64; 3]>,
    #[serde(default)]
    pub(crate) wall: Vec<RawWall>,
    #[serde(default)]
    pub(crate) block: Vec<RawBlock>,
    #[serde(default)]
    pub(crate) leaf: Vec<RawLeaf>,
    #[serde(default)]
    pub(crate) place: Vec<RawPlace>,
    #[serde(default)]
    pub(crate) room: Vec<RawRoom>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawWall {
    pub(crate) name: Spanned<String>,
    pub(crate) from: Spanned<[f64; 2]>,
    pub(crate) to: Spanned<[f64; 2]>,
    #[serde(default)]
    pub(crate) doors: Vec<Spanned<[f64; 2]>>,
    #[serde(default)]
    pub(crate) surface: Surface,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawLeaf {
    pub(crate) name: Spanned<String>,
    pub(crate) at: Spanned<[f64; 2]>,
    pub(crate) width: Spanned<f64>,
    #[serde(default)]
    pub(crate) turned: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawRoom {
    pub(crate) name: Spanned<String>,
    pub(crate) from: Spanned<[f64; 2]>,
    pub(crate) to: Spanned<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawBlock {
    pub(crate) name: Spanned<String>,
    pub(crate) kind: RawKind,
    pub(crate) at: Spanned<[f64; 2]>,
    pub(crate) size: Spanned<[f64; 2]>,
    #[serde(default)]
    pub(crate) turned: Option<Spanned<f64>>,
    #[serde(default)]
    pub(crate) surface: Surface,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum RawKind {
    Desk,
    Table,
    Chair,
    Cabinet,
    Box,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawPlace {
    pub(crate) name: Spanned<String>,
    pub(crate) at: Spanned<[f64; 2]>,
    pub(crate) goal: Option<bool>,
}
