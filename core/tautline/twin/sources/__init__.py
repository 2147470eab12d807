"""Where sensor data come from: files, standard input, MQTT, OPC UA."""
