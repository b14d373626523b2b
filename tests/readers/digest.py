import hashlib, json, struct, sys
from mcap.reader import make_reader

def leaves(value):
    return sum(map(leaves, value.values()), []) if isinstance(value, dict) else [value]

hashes = {}
for schema, channel, message in make_reader(open(sys.argv[1], "rb")).iter_messages():
    if channel.message_encoding == "json" and not channel.topic.startswith("/fit/"):
        values = leaves({**json.loads(message.data), "timestamp": {}})
        numbers = [value for value in values if not isinstance(value, str)]
        texts = [value.encode() for value in values if isinstance(value, str)]
        id, hash, count = hashes.get(channel.topic, (channel.id, hashlib.sha256(), 0))
        hash.update(struct.pack(f"<IQ{len(numbers)}d", message.sequence, message.log_time, *numbers))
        hash.update(b"".join(struct.pack("<Q", len(text)) + text for text in texts))
        hashes[channel.topic] = min(id, channel.id), hash, count + 1  # other software may split a topic
content = hashlib.sha256()
for topic, (_, hash, count) in sorted(hashes.items(), key=lambda item: item[1][0]):
    content.update(topic.encode() + b"\0" + struct.pack("<Q", count) + hash.digest())
print(content.hexdigest())
