//! `toprise schema`.

use super::{Done, format, output};
use crate::telemetry::schema::{file_name, json_schema};
use crate::telemetry::{ChannelInfo, Telemetry, channels};
use anyhow::{Context as _, Error};
use std::fs;
use std::path::Path;

/// Lists the channels, prints one schema, or writes all.
pub(super) fn schema(topic: Option<&str>, directory: Option<&Path>) -> Result<Done, Error> {
    if let Some(directory) = directory {
        write_all(directory)?;
        return Ok(Done::Well);
    }
    let Some(topic) = topic else {
        output::print(&list())?;
        return Ok(Done::Well);
    };
    // Checks the name and tells which there are.
    let one = Telemetry::with_topics(&[topic.to_owned()])?;
    let wanted = channels().iter().enumerate();
    for (_, channel) in wanted.filter(|(index, _)| one.wants(*index)) {
        output::print(&json_schema(channel))?;
    }
    Ok(Done::Well)
}

fn list() -> String {
    let row = |channel: &ChannelInfo| {
        vec![
            channel.topic.to_owned(),
            channel.schema.to_owned(),
            channel.meaning.to_owned(),
        ]
    };
    format::table(&channels().iter().map(row).collect::<Vec<_>>(), &[])
}

fn write_all(directory: &Path) -> Result<(), Error> {
    fs::create_dir_all(directory)
        .with_context(|| format!("cannot create {}", directory.display()))?;
    for channel in channels() {
        let path = directory.join(file_name(channel));
        fs::write(&path, json_schema(channel))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}
