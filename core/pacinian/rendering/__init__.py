"""The render loop: sample, propagate, solve, modulate, quantise, send.

The loop
    renderer.py               the API: `Renderer`, its options and defaults; a tick never raises
    loop_settings.py          settings of the loop that do not change while it runs: rate, `peak`, `strict`, ...
    pipeline.py               one tick: starts solves in it or in the background, and takes their results
    tick_pacing.py            when ticks are due, and which are skipped when the loop is late
    clock.py                  the clock, which tests replace
    warmup.py                 what is loaded and tried before the first tick
    skin_loader.py            builds the skin of the first hand of a kind, while the output is silent
    realtime_section.py       keeps garbage collection, BLAS and other threads from delaying ticks
    fail_safe_output.py       reports an exception in a tick, and silences the output until a reset
    renderer_from_file.py     a renderer from a scene file
Solve
    scene_solver.py           samples a scene and solves for it: the job of a tick, or in the background
    solve_deadline.py         how long a solve may take
    sample_solver.py          solves for samples; reuses solutions while nothing moves
    steered_solver.py         one object that moves in free air: when to solve for it again, when to steer its field
    cached_solution.py        a solution as it is kept, whether it needs another solve, and the pause before a retry
    solution_sequence.py      the solutions that the ticks play (a cycle, a modulation); the result of a job
    background_schedule.py    solve in the ticks or in the background; how often; over how many ticks a change is spread
    background_solve.py       the thread that solves in the background
    sample_budget_controller.py   how many samples there may be when time is short
    reachability.py           samples that sound reaches: in front of the array, not hidden, skin not turned away
    reachability.hpp          sound power that reaches a place, from a grid of cells: called by reachability.py
    frame_cycle.py            a region rendered by several frames in turn, whose mean meets the target; their number
    skin_limit.py             keeps the pressure on all skin that is seen within `peak`, also between the samples
    zone_limit.py             keeps quiet zones quiet after rounding by the device
    new_hand_check.py         whether a new hand might get more than `peak`, so that the output must be silent
From gains to levels
    playback.py               one frame in each tick from what has been solved; calls those below
    modulator.py              rows of gains: follows solutions, plays cycles, applies envelopes
    contact_follower.py       how far contacts with skin have moved from one solution to the next
    field_steering.py         how a field is steered: factors on the gains, and where the object is between solves
    field_steering.hpp        these factors: called by field_steering.py
    smoothing.py              interpolates the gains from one solution to the next; limits their slew rate
    smoothing.hpp             aligns and fades rows: called by smoothing.py
    envelope_gains.py         applies envelopes to gains; fades from the envelopes of one solution to those of the next
    envelope_groups.py        samples that share an envelope (voices), and their contribution to the gains
    row_times.py              how many rows a frame has, and when each sounds
    quantiser.py              rounds gains to the device's levels: ceiling, dither, amplitude table
    quantiser.hpp             the rounding: called by quantiser.py
What is reported
    report.py                 counts, tick times and their stages, errors, faults
    stage_timer.py            the present stage of a tick, and the total time of each stage
    deviation_log.py          what was left out or changed, by object and reason, over time
    frame_deviations.py       what one frame leaves out or changes, by object and reason
    weak_samples.py           samples that press less than asked, as far as skin could feel it
    scene_warnings.py         what to warn about before a run
    felt_monitor.py           keeps what some ticks have emitted, and measures it in the background
    measurement_schedule.py   when the emitted field is measured
    emitted_measurement.py    the emitted field between the samples, and on touched skin
Recordings
    recording.py              the file: written tick by tick, read up to its last whole tick
    scene_log.py              changes of the scene from tick to tick, as they are written
    embedded_files.py         meshes, textures and sounds inside a recording
    recorded_settings.py      the renderer's settings inside a recording
    recording_clock.py        clock readings inside a recording, so that decisions repeat
    replay.py                 plays a recording on a backend
    rerender.py               renders a recording again, and compares the frames
    library_versions.py       versions and variants of libraries on which frames depend

The solver returns a `Solution`, and a `CachedSolution` keeps it. A `SolutionSequence` contains the cached solutions of
all frames of a cycle, or of all steps of a modulation. A `SolveResult` passes it from the job that solved to the tick
that plays it.
"""
