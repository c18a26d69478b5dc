"""The server of the live viewer: a page in the browser that shows what a running server emits, or a recording.

run.py       all of it, until Ctrl-C                          app.py           HTTP: the page, its token, the websocket
hub.py       the newest values, for all pages                 feed.py          one page: messages to it and from it
bridge.py    a client of the running server, in a thread      states.py        reads the states and frames it publishes
slices.py    computes the field, in its own process           model.py         the array and medium of the field
browser.py   opens the page                                   messages.py      messages between pages and viewer
page/        the page's files, built from viewer/             scene_mirror.py  the objects of the rendered scene
history.py   past values for the charts of a recording        feed_file.py     writes and reads feed files
recording_tick_stats.py  tick times of a renderer's recording    feed_player.py   plays a feed file in place of a server
recent_frames.py      the last frames, for their mean         recording_to_feed.py  converts a renderer's recording
region_error.py       pressure on skin minus its target       demonstration.py      a hand on a ball, for an empty page
"""
