"""Reads a recording with the PyPI package `mcap`, which knows nothing of subsumed, and holds it to what it says.

usage: mcap_check.py FILE [LOST_ALLOWED]
"""
import json
import sys
from collections import defaultdict

from mcap.reader import make_reader

path, lost_allowed = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 0
numbers = defaultdict(set)
topics = defaultdict(int)
with open(path, "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    summary = reader.get_summary()
    metadata = {m.name: m.metadata for m in reader.iter_metadata()}
    attachments = {a.name: a.data for a in reader.iter_attachments()}
    for schema, channel, message in reader.iter_messages():
        assert channel.message_encoding == "json" and schema.encoding == "jsonschema", channel.topic
        shape = json.loads(schema.data)
        told = json.loads(message.data)
        unknown = set(told) - set(shape["properties"])
        assert not unknown, f"{channel.topic}: {unknown} are not in the schema"
        topics[channel.topic] += 1
        if channel.topic.startswith("/wires/") and not told.get("before"):
            numbers[(channel.topic, channel.id)].add(told["number"])

manifest = json.loads(metadata["subsumed"]["manifest"])
assert manifest["format"] == 1 and manifest["sources"], "the manifest describes the creature"
assert b"[[layer]]" in attachments["creature.toml"], "the creature file is attached"
assert summary.statistics.message_count == sum(topics.values())
for topic in ["/wires/body.odometry", "/commands/body.turn", "/beats/motor", "/halts"]:
    assert topics[topic] > 0, f"nothing on {topic}"
missing = {t: max(n) - min(n) + 1 - len(n) for (t, _), n in numbers.items()}
told = {t: int(n) for t, n in metadata["subsumed.losses"].items() if t.startswith("/")}
assert {t: n for t, n in missing.items() if n} == told, f"losses are told as they are: {missing} against {told}"
assert sum(missing.values()) <= lost_allowed, f"lost: {missing}"
print(f"{path}: {sum(topics.values())} messages on {len(topics)} topics, {sum(missing.values())} lost, all told")
