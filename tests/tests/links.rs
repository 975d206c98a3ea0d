//! Links: every relative link of the documentation leads to a file that is there, also from where the book shows it.
//!
//! Must never reach out to the network: what lies elsewhere is not looked at.

use std::fs;
use std::path::{Path, PathBuf};

/// The folders with documentation, besides the files at the root.
const FOLDERS: [&str; 7] = ["ipc", "layers", "daemon", "tools", "tests", "deploy", "docs"];

fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().expect("the crate lies in the workspace").into()
}

/// Every file of the documentation.
fn pages() -> Vec<PathBuf> {
    let mut open: Vec<PathBuf> = FOLDERS.iter().map(|f| root().join(f)).collect();
    let mut found = Vec::new();
    let at_root = fs::read_dir(root()).expect("the root can be read").flatten();
    found.extend(at_root.map(|e| e.path()).filter(|p| p.is_file()));
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder can be read").flatten() {
            let (path, name) = (entry.path(), entry.file_name());
            let skipped = name == "target" || name == "book" || name.to_string_lossy().starts_with('.');
            match path.is_dir() {
                true if skipped => {}
                true => open.push(path),
                false => found.push(path),
            }
        }
    }
    found.retain(|path| path.extension().is_some_and(|end| end == "md"));
    found
}

/// Where the links of a text lead that are neither addresses nor places in the same text.
fn links(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut fenced = false;
    for line in text.lines() {
        fenced ^= line.trim_start().starts_with("```");
        // What stands between grave accents is code: the even parts do not.
        let prose: String = line.split('`').step_by(2).collect();
        for rest in prose.split("](").skip(1).filter(|_| !fenced) {
            let target = rest.split([')', '#', ' ']).next().unwrap_or_default();
            if !target.is_empty() && !target.contains("://") && !target.starts_with("mailto:") {
                found.push(target.to_string());
            }
        }
    }
    found
}

/// The text as the book shows it: files that a page includes stand in their places.
fn shown(page: &Path, text: &str) -> String {
    let parts = text.split("{{#include ");
    let mut shown = String::new();
    for (k, part) in parts.enumerate() {
        let Some((name, rest)) = part.split_once("}}").filter(|_| k > 0) else {
            shown.push_str(part);
            continue;
        };
        let file = page.with_file_name(name.split(':').next().unwrap_or(name));
        let read = fs::read_to_string(&file);
        shown.push_str(
            &read.unwrap_or_else(|e| panic!("{} includes {}: {e}", page.display(), file.display())),
        );
        shown.push_str(rest);
    }
    shown
}

#[test]
fn every_relative_link_leads_to_a_file() {
    let (mut seen, mut dead) = (0, Vec::new());
    for page in pages() {
        let text = fs::read_to_string(&page).expect("documentation is text");
        for link in links(&shown(&page, &text)) {
            seen += 1;
            if !page.with_file_name(&link).exists() {
                dead.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(dead.is_empty(), "links that lead nowhere:\n{}", dead.join("\n"));
    assert!(seen > 40, "links were found: {seen}");
}

#[test]
fn every_page_of_the_book_stands_in_its_summary() {
    let book = root().join("docs/src");
    let summary = fs::read_to_string(book.join("SUMMARY.md")).expect("there is a summary");
    let listed = links(&summary);
    for page in pages().iter().filter(|page| page.starts_with(&book)) {
        let short = page.strip_prefix(&book).expect("below it").display().to_string();
        let known = short == "SUMMARY.md" || listed.contains(&short);
        assert!(
            known,
            "{short} is a page of the book that its summary does not name"
        );
    }
}
