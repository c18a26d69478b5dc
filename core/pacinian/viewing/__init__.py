"""The server of the live viewer: a page in the browser that shows what a running server emits, or a recording.

run.py                                   all of it, until Ctrl-C
app.py, feed.py, messages.py             HTTP and the token; one page; messages between pages and viewer
hub.py, server_connection.py, states.py   newest values for all pages; a client of the server; its states and frames
scene_mirror.py, recent_frames.py, modulation.py   objects of the rendered scene; the last frames, for their mean
slices.py, array_model.py, region_error.py   the field, in its own process; its array; pressure on skin minus its target
feed_file.py, feed_player.py, history.py   recordings of the viewer: written and read, played, their charts
recording_to_feed.py, recording_tick_stats.py, tick_histogram.py   recordings of a renderer as a feed; tick times
demonstration.py, browser.py, page/      a hand on a ball for an empty page; opens the page; its built files
"""
