"""The server of the live viewer: a page in the browser that shows what a running server emits, or a recording.

run.py                   runs all of it, until Ctrl-C
app.py                   HTTP on loopback, token, content security policy, websockets
page_connection.py       the connection to one page: its messages and requests, at most 40 slices a second; slow pages
messages.py              messages between pages and viewer (docs/viewer-feed.md); their version
hub.py                   newest values for all pages
server_connection.py     a client of the server in a thread: passes on requests (arm, stop, select), reconnects
states.py                reads published states and frames, polls scene and properties
scene_mirror.py          copy of the rendered scene; each object is sent once
recent_frames.py         the last frames, for the mean of a modulated field
time_shares.py           shares of time of these frames, from envelopes
slices.py                computes the field in planes and boxes and on skin
field_process.py         the process of low priority that does this
array_model.py           array and medium of that process
region_error.py          felt pressure minus target on regions, between samples too
feed_file.py             recordings of the viewer (.feed): written and read
feed_player.py           plays a recording: from any time, at any speed
history.py               drive and error of the last 30 s, for the page's charts (panels/chart-series.ts)
recording_to_feed.py     recording of `pacinian render --record` to a feed
recording_tick_stats.py  statistics of a recording's ticks
tick_histogram.py        histogram of tick times
demonstration.py         a hand on a ball, for an empty page
browser.py               opens the page without showing its token
page/                    the built page, from viewer/ in the project's root
"""
