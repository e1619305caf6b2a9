"""Prints an MCAP file of one channel as JSON: topic, schema, metadata, messages. Arguments: file, and --cut if it has no end."""

import json
import sys

from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader, make_reader

path, *cut = sys.argv[1:]
found = {"messages": []}
with open(path, "rb") as file:
    reader = NonSeekingReader(file) if cut else make_reader(file)
    try:
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert channel.message_encoding == "json" and schema.encoding == "jsonschema"
            found["topic"], found["schema"] = channel.topic, json.loads(schema.data)
            found["messages"].append({"log_time": message.log_time, "row": json.loads(message.data)})
    except McapError:
        assert cut
    if not cut:
        (found["metadata"],) = [record.metadata for record in reader.iter_metadata()]
print(json.dumps(found))
