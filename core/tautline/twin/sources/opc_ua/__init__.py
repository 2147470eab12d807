"""OPC UA: the client, the variables of a server, and readings that hold until another one is sent."""
