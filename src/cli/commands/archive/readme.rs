//! The README of an archive.

use super::parts::{Archive, ArchiveFile};
use crate::words::markdown_line;
use crate::words::number::bytes;

/// The text of `README.md`.
pub(super) fn text(archive: &Archive, files: &[ArchiveFile]) -> String {
    let about = &archive.about;
    let creators = about.creators.iter().map(|creator| creator.name.as_str());
    let creators: Vec<&str> = creators.collect();
    let (title, creators) = (
        markdown_line(about.title.as_str()),
        markdown_line(&creators.join("; ")),
    );
    let mut text = format!("# {title}\n\n{creators}, {}.", about.date);
    if let Some(doi) = &about.doi {
        text.push_str(&format!(" <https://doi.org/{}>", doi.as_str()));
    }
    text.push_str("\n\n");
    if let Some(description) = &about.description {
        text.push_str(&format!("{}\n\n", markdown_line(description.as_str())));
    }
    let (licence, address) = (about.licence.name, about.licence.address());
    text.push_str(&format!("Licence: [{licence}]({address}).\n\n"));
    text.push_str(&verification(&archive.maker.version));
    text.push_str("## Files\n\n| file | content | size |\n|---|---|---|\n");
    for file in files {
        let (name, meaning, size) = (&file.name, &file.meaning, bytes(file.bytes));
        text.push_str(&format!("| [`{name}`](<{name}>) | {meaning} | {size} |\n"));
    }
    text
}

fn verification(version: &str) -> String {
    format!(
        "## Verify\n\n\
        ```sh\n\
        toprise verify .        # runs the scenarios again, and compares every file\n\
        sha256sum -c SHA256SUMS # without toprise: are the files those that were archived?\n\
        ```\n\n\
        Each recording is an MCAP file (<https://mcap.dev>) that holds its scenario; toprise {version} made this archive. \
        Every later 1.x verifies the recordings. In JSON recordings every message is readable as it is, and schemas in the \
        file give units and meanings; the format and the digest are documented with toprise (docs/format.md).\n\n"
    )
}
