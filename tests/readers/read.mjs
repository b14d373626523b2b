// Reads a recording with the MCAP libraries for JavaScript, on which Foxglove and Lichtblick are
// built: through the index, as they do, and from front to back with all checksums compared. Prints
// one line of JSON.

import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { FileHandleReadable } from "@mcap/nodejs";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";
import { open } from "node:fs/promises";

const utf8 = new TextDecoder("utf-8", { fatal: true });

// A function from a message's bytes to an object; nothing for the channels of ROS 2.
function decoder(channel, schema) {
  if (channel.messageEncoding === "json") {
    return (data) => JSON.parse(utf8.decode(data));
  }
  if (channel.messageEncoding === "protobuf") {
    const type = protobufFromBinaryDescriptor(schema.data).lookupType(schema.name);
    return (data) => type.decode(data);
  }
  return undefined;
}

function count(counts, topic) {
  counts[topic] = (counts[topic] ?? 0) + 1;
}

async function readIndexed(file, decompressHandlers) {
  const readable = new FileHandleReadable(file);
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const counts = {};
  const decoders = new Map();
  let sumTheta = 0;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!decoders.has(channel.id)) {
      decoders.set(channel.id, decoder(channel, schema));
    }
    const decoded = decoders.get(channel.id)?.(message.data);
    count(counts, channel.topic);
    if (channel.topic === "/top/state") {
      sumTheta += decoded.theta;
    }
  }
  return [counts, sumTheta];
}

async function readStreamed(file, decompressHandlers) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const counts = {};
  const topics = new Map();
  const buffer = new Uint8Array(1 << 20);
  let position = 0;
  for (;;) {
    const { bytesRead } = await file.read(buffer, 0, buffer.length, position);
    if (bytesRead === 0) {
      break;
    }
    position += bytesRead;
    reader.append(buffer.subarray(0, bytesRead));
    for (let record; (record = reader.nextRecord()) != undefined; ) {
      if (record.type === "Channel") {
        topics.set(record.id, record.topic);
      } else if (record.type === "Message") {
        count(counts, topics.get(record.channelId));
      }
    }
  }
  if (!reader.done()) {
    throw new Error("the file has no end");
  }
  return counts;
}

if (process.argv.length !== 3) {
  console.error("usage: read.mjs RECORDING.mcap");
  process.exit(2);
}
const decompressHandlers = await loadDecompressHandlers();
const file = await open(process.argv[2], "r");
try {
  const [indexed, sumTheta] = await readIndexed(file, decompressHandlers);
  const streamed = await readStreamed(file, decompressHandlers);
  console.log(JSON.stringify({ indexed, streamed, sum_theta: sumTheta }));
} finally {
  await file.close();
}
