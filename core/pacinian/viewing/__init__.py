"""The live viewer's server: a page in the browser that shows what a running server emits, or a recording.

run.py       all of it, until Ctrl-C                          app.py          HTTP: the page, its token, the websocket
hub.py       the newest of everything, for all pages          feed.py         one page: what it is sent, what it asks
bridge.py    a client of the running server, in a thread      states.py       what it brings from there
slices.py    the field, in a process of its own               model.py        what that is computed from
scenery.py   objects, each told once                          messages.py     what pages and server say to each other
recorded.py  the feed to a file, and back                     player.py       a recording in place of a server
browser.py   opens the page                                   transcribed.py  a renderer's recording as a feed
page/        what the browser loads, built from viewer/       past.py         what its ticks were like
recent.py    the frames of the last moments, for their mean   history.py      charts of a recording before a time
region_error.py  what is felt on skin, less what is asked     demonstration.py  a hand on a ball, for an empty page
"""
