//! Large files whose chunks overlap in time.

use crate::bench::Trial;
use crate::program::{errors, start, wait};
use mcap::records::MessageHeader;
use mcap::{McapResult, WriteOptions};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::time::Duration;
use tempfile::tempdir;

/// Content: 1 GB.
const MESSAGES: u64 = 10_000;
const MESSAGE: usize = 100_000;
/// Messages of a chunk.
const IN_CHUNK: u64 = 40;

/// What the comparison may cost on a busy machine, in time and memory (bytes): one file is read in order of time within
/// 256 MiB, the other has chunks of 4 MB.
const LIMIT: Duration = Duration::from_mins(5);
const MEMORY: u64 = (256 << 20) + 50_000_000;

/// Compares a file of 1 GB whose chunks all span its whole time with the same messages in order of time.
pub fn overlaps() -> Result<Trial, String> {
    Ok(Box::new(|_| {
        let directory = tempdir().unwrap();
        let room = directory.path();
        let chunks = MESSAGES / IN_CHUNK;
        let overlapping = (0..MESSAGES).map(|n| n / IN_CHUNK + n % IN_CHUNK * chunks);
        write(&room.join("overlaps.mcap"), overlapping).map_err(|error| error.to_string())?;
        write(&room.join("sorted.mcap"), 0..MESSAGES).map_err(|error| error.to_string())?;
        let described = |error: String| format!("{error}: {}", errors(room));
        let program = start(room, &["diff", "overlaps.mcap", "sorted.mcap"]);
        let ended = wait(program, LIMIT).map_err(described)?;
        match ended.code {
            Some(0) if ended.memory <= MEMORY => Ok(()),
            Some(0) => Err(described(format!(
                "it took {} MB",
                ended.memory / 1_000_000
            ))),
            code => Err(described(format!("exit code {code:?}"))),
        }
    }))
}

/// Writes messages with these times, each with its number as sequence number.
fn write(path: &Path, times: impl Iterator<Item = u64>) -> McapResult<()> {
    let options = WriteOptions::new().compression(None).chunk_size(None);
    let mut writer = options.create(BufWriter::new(File::create(path)?))?;
    let channel_id = writer.add_channel(0, "/a", "raw", &BTreeMap::new())?;
    for (count, time) in (1..).zip(times) {
        let header = MessageHeader {
            channel_id,
            sequence: time as u32,
            log_time: time,
            publish_time: time,
        };
        writer.write_to_known_channel(&header, &vec![time as u8; MESSAGE])?;
        if count % IN_CHUNK == 0 {
            writer.flush()?;
        }
    }
    writer.finish()?;
    Ok(())
}
