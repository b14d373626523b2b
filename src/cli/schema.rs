//! `toprise schema`.

use super::{Done, EncodingName, format, output};
use crate::archive::publish::{self, Existing};
use crate::telemetry::protobuf::{proto_file, proto_file_name};
use crate::telemetry::schema::{file_name, json_schema};
use crate::telemetry::{ChannelInfo, Topic, UnknownTopic, channels};
use anyhow::Error;
use std::path::Path;

/// Lists the channels, prints one schema, or writes all.
pub(super) fn schema(
    topic: Option<&str>,
    encoding: EncodingName,
    directory: Option<&Path>,
) -> Result<Done, Error> {
    if let Some(directory) = directory {
        write_all(directory)?;
        return Ok(Done::Well);
    }
    let Some(topic) = topic else {
        output::print(&list())?;
        return Ok(Done::Well);
    };
    let topic = Topic::find(topic).ok_or_else(|| UnknownTopic {
        name: topic.to_owned(),
    })?;
    output::print(&match encoding {
        EncodingName::Json => json_schema(topic.info()),
        EncodingName::Protobuf => proto_file(topic.info()),
    })?;
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
    for channel in channels() {
        let files = [
            (file_name(channel), json_schema(channel)),
            (proto_file_name(channel), proto_file(channel)),
        ];
        for (name, text) in files {
            publish::write(&directory.join(name), Existing::Replace, text.as_bytes())?;
        }
    }
    for (name, text) in crate::analysis::diff::schemas() {
        publish::write(&directory.join(name), Existing::Replace, text.as_bytes())?;
    }
    Ok(())
}
