"""The server of the live viewer: a page in the browser that shows what a running server emits, or a recording.

run                                  all of it, until Ctrl-C
app, feed, messages                  HTTP and the token; one page; messages between pages and viewer
hub, bridge, states                  newest values for all pages; a client of the server; its states and frames
scene_mirror, recent_frames          the objects of the rendered scene; the last frames, for their mean
slices, array_model, region_error    the field, in its own process; its array; pressure on skin minus its target
feed_file, feed_player, history      recordings of the viewer: written and read, played, their charts
recording_to_feed, recording_tick_stats, tick_histogram   recordings of a renderer: converted to a feed; tick times
demonstration, browser, page/        a hand on a ball for an empty page; opens the page; its files, built from viewer/
"""
