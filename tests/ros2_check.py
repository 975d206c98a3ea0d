"""Reads an export with the PyPI package `rosbags`, which knows nothing of subsumed, and holds it to the recording.

usage: ros2_check.py RECORDING EXPORT
"""
import json
import math
import sys
from collections import defaultdict

from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

recording, export = sys.argv[1:]
told = defaultdict(list)
with open(recording, "rb") as file:
    for _, channel, message in make_reader(file).iter_messages():
        if channel.topic.startswith(("/wires/", "/commands/")):
            told[channel.topic.replace(".", "/")].append((message.log_time, json.loads(message.data)))

store = get_typestore(Stores.ROS2_HUMBLE)
read = defaultdict(list)
types = {}
with open(export, "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    assert reader.get_header().profile == "ros2", reader.get_header().profile
    for schema, channel, message in reader.iter_messages():
        assert schema.encoding == "ros2msg" and channel.message_encoding == "cdr", channel.topic
        if schema.name not in types:
            types[schema.name] = get_types_from_msg(schema.data.decode(), schema.name)
            for name, fields in types[schema.name].items():
                if name in store.fielddefs:
                    # In CDR nothing has a member all the same; a definition does not say so.
                    own = [f for f in store.fielddefs[name][1] if f[0] != "structure_needs_at_least_one_member"]
                    assert fields[1] == own, f"{name}: {fields} against {store.fielddefs[name]}"
                else:
                    store.register({name: fields})
        read[channel.topic].append((message.log_time, schema.name, store.deserialize_cdr(message.data, schema.name)))

assert "/rosout" in read and "/halts" in read and "/taps" in read, sorted(read)
kinds = set()
for topic, messages in told.items():
    others = read[topic]
    assert len(others) == len(messages), f"{topic}: {len(messages)} recorded, {len(others)} exported"
    for (time, ours), (other_time, name, other) in zip(messages, others):
        kinds.add(name)
        assert time == other_time, topic
        if name.endswith("Float64"):
            assert other.data == ours["value"] or (ours["value"] is None and math.isnan(other.data)), topic
        elif name.endswith("Bool"):
            assert other.data == ours["value"], topic
        elif name.endswith("Vector3Stamped"):
            assert (other.vector.x, other.vector.y) == (ours["x"], ours["y"]), topic
        elif name.endswith("Polar"):
            assert (other.length, other.bearing) == (ours["length"], ours["bearing"]), topic
        elif name.endswith("LaserScan"):
            assert len(other.ranges) == 12 == round(2 * math.pi / other.angle_increment), topic
            assert all(abs(a - b) < 1e-5 for a, b in zip(other.ranges, ours["ranges"])), topic
        elif name.endswith("PoseStamped"):
            turned = 2 * math.atan2(other.pose.orientation.z, other.pose.orientation.w)
            assert (other.pose.position.x, other.pose.position.y) == (ours["x"], ours["y"]), topic
            assert abs(math.remainder(turned - ours["heading"], 2 * math.pi)) < 1e-9, topic
        if hasattr(other, "header"):
            assert other.header.stamp.sec * 10**9 + other.header.stamp.nanosec == time, topic
assert {"std_msgs/msg/Float64", "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/PoseStamped"} <= kinds, kinds
print(f"{export}: {sum(map(len, read.values()))} messages, {len(types)} types, all as recorded")
