"""Many runs of a scene by a plan, on threads or a cluster: what varies, who runs it, the journal, table and figures."""
