"""The render loop: sample, propagate, solve, modulate, quantise, send.

The loop
    renderer.py, pipeline.py          the API; one tick, from a scene to a frame
    settings.py, scene_renderer.py    settings as plain values; a renderer from a scene file
    clock.py, tick_pacing.py          time; when ticks are due, and which are skipped
    warmup.py, realtime_section.py    what is done before the first tick, and against delays
    fail_safe_output.py               the backend, whose failures silence the output
Solve
    sample_solver.py, cached_solution.py, outcome.py   solve for samples, reuse solutions, pass them on
    background_schedule.py, background_solve.py   solve in ticks, or beside them
    sample_budget_controller.py       how many samples
    reachability.py, cycle.py         samples that sound reaches; regions rendered by several frames in turn
    skin_limit.py                     the pressure limit on all skin that is seen
From gains to levels
    modulator.py, row_times.py, envelope_groups.py, mixing.py   rows of gains, with their envelopes
    slew_limiter.py, quantiser.py     no jumps; levels of the device
What is reported
    report.py, deviations.py, frame_deviations.py   counts and times; what is left out or changed
    scene_warnings.py                 what to warn about before a run
    measurement_schedule.py, emitted_measurement.py, audibility.py   the emitted field; audible sound
Recordings
    recording.py, recording_clock.py, scene_log.py, recorded_files.py   written and read
    replay.py, rerender.py, library_versions.py   played; rendered again, and what may differ
"""
