"""Reads scrapes in their order with prometheus_client, and the example configuration: FOLDER SCRAPE..."""

import sys

import yaml
from prometheus_client.openmetrics.parser import text_string_to_metric_families

folder, scrapes = sys.argv[1], sys.argv[2:]
counted = {}
for path in scrapes:
    families = list(text_string_to_metric_families(open(path).read()))
    assert len(families) >= 15, f"{path}: {len(families)} families"
    for family in families:
        assert family.documentation, f"{path}: {family.name} says nothing of itself"
        for sample in family.samples:
            key = (sample.name, tuple(sorted(sample.labels.items())))
            counts = family.type == "counter" or sample.name.endswith(("_bucket", "_count", "_sum"))
            if counts and "from" not in sample.labels and "wire" not in sample.labels:
                assert sample.value >= counted.get(key, 0), f"{path}: {key} went backwards"
                counted[key] = sample.value
            if sample.name == "subsumed_latency_seconds_count":
                beats = next(f for f in families if f.name == "subsumed_beats").samples
                of_layer = next(s for s in beats if s.labels == sample.labels)
                assert 0 < sample.value <= of_layer.value, f"{path}: {sample.labels}: {sample.value} latencies, {of_layer.value} beats"

jobs = yaml.safe_load(open(f"{folder}/scrape.yml"))
assert jobs["scrape_configs"][0]["scrape_protocols"] == ["OpenMetricsText1.0.0"]
rules = [rule for group in yaml.safe_load(open(f"{folder}/{jobs['rule_files'][0]}"))["groups"] for rule in group["rules"]]
assert len(rules) >= 5 and all(rule["alert"] and rule["expr"] and rule["annotations"]["summary"] for rule in rules)
print(f"{len(scrapes)} scrapes read, {len(counted)} counters that never went backwards, {len(rules)} alert rules")
