"""A simulation that runs beside the machine: sensor data in; estimates, hidden quantities and alarms out."""
