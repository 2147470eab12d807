"""What an application is, where it is found, and working defaults for every verb.

:class:`~tautline.application.defaults.Defaults` is the base of an application of one file,
:class:`~tautline.application.packaged.Packaged` that of a package, and :func:`~tautline.application.installed.register`
makes one known that is not installed. The command line and the Python interface both stand on this room.
"""
