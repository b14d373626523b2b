//! Small files that claim to be huge.

use crate::bench::{Random, Trial};
use crate::program::{errors, start, wait};
use std::fs;
use std::time::Duration;
use tempfile::tempdir;

/// What a small file may cost on a busy machine, in time and memory (bytes).
const LIMIT: Duration = Duration::from_secs(20);
const MEMORY: u64 = 700_000_000;

/// Opens files whose chunks unpack to much more than their size, or claim to, with every command.
pub fn bombs() -> Result<Trial, String> {
    const VERBS: [&[&str]; 7] = [
        &["info", "bomb.mcap"],
        &["verify", "bomb.mcap"],
        &["diff", "bomb.mcap", "bomb.mcap"],
        &["diff", "bomb.mcap", "other.mcap"],
        &["explain", "bomb.mcap"],
        &["run", "bomb.mcap", "-o", "x.mcap"],
        &["figures", "bomb.mcap", "-o", "figures"],
    ];
    Ok(Box::new(|random| {
        let directory = tempdir().unwrap();
        let room = directory.path();
        fs::write(room.join("bomb.mcap"), bomb(random)).unwrap();
        fs::write(room.join("other.mcap"), bomb(random)).unwrap();
        let arguments = random.one_of(&VERBS);
        let described = |error: String| format!("{arguments:?}: {error}: {}", errors(room));
        let ended = wait(start(room, arguments), LIMIT).map_err(described)?;
        match ended.code {
            None => Err(described("a signal ended it".to_owned())),
            Some(_) if ended.memory > MEMORY => Err(described(format!(
                "it took {} MB",
                ended.memory / 1_000_000
            ))),
            Some(_) => Ok(()),
        }
    }))
}

fn bomb(random: &mut Random) -> Vec<u8> {
    let library: &[u8] = if random.below(2) == 0 {
        b"toprise/0.1.0"
    } else {
        b"other"
    };
    let mut bytes = b"\x89MCAP0\r\n".to_vec();
    let header = [&0_u32.to_le_bytes()[..], &text(library)].concat();
    bytes.extend(record(1, &header));
    for _ in 0..=random.below(3) {
        bytes.extend(record(6, &chunk(random)));
    }
    if random.below(2) == 0 {
        bytes.extend(record(15, &[0; 4]));
        bytes.extend(record(2, &[0; 20]));
        bytes.extend(b"\x89MCAP0\r\n");
    }
    bytes
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text].concat()
}

/// A chunk of up to 2 GiB of one byte, as runs of 128 KiB; the size in its header may be wrong.
fn chunk(random: &mut Random) -> Vec<u8> {
    const RUN: u64 = 128 * 1024;
    let runs = random.about(8.0, 16_384.0) as u64;
    let byte = *random.one_of(&[0, 1, 3, 5, 0xff]);
    // A zstd frame: magic, no size, a window of 128 KiB, runs of one byte.
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0, 7 << 3];
    for run in 1..=runs {
        let head = u32::from(run == runs) | 1 << 1 | (RUN as u32) << 3;
        frame.extend(&head.to_le_bytes()[..3]);
        frame.push(byte);
    }
    let size = *random.one_of(&[runs * RUN, runs * RUN, RUN, 0, u64::MAX, 1 << 40]);
    let mut body = [[0_u8; 8], 1_000_u64.to_le_bytes()].concat();
    body.extend(size.to_le_bytes());
    body.extend([0; 4]);
    body.extend(text(
        random
            .one_of(&[b"zstd", b"zstd", b"zstd", b"lz4 "])
            .trim_ascii(),
    ));
    body.extend((frame.len() as u64).to_le_bytes());
    body.extend(frame);
    body
}
