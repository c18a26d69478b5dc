"""The command `pacinian`, one file a subcommand.

main.py                    the command: groups of subcommands, errors, exit codes
demo.py                    `pacinian demo`: a moving ball on a simulated array, as a picture
doctor.py                  `pacinian doctor`: prints findings about this machine
doctor_probes.py           what `doctor` measures: Python, libraries, kernels, processor, memory, clock, USB, server
doctor_rules.py            what `doctor` says about it, with advice
engines.py                 `pacinian unity`, `pacinian unreal`
engine_package.py          copies an engine's package into a project, all or nothing, and keeps changed files
package_links.py           links and pictures of the pages of such a copy
serve.py                   `pacinian serve`: runs the server
stop.py                    `pacinian stop`: emergency stop
render.py                  `pacinian render`: renders a scene file, without a server; `--record`
replay.py                  `pacinian replay`: plays the frames of a recording of `render`
rerender.py                `pacinian rerender`: renders the scenes of a recording again and compares the frames
run_output.py              progress bar and summary of `demo` and `render`; saves the picture of plot/
run_verdict.py             whether the ticks of a run were on time; if not, why
plugin_blame.py            errors and exits of plug-ins in `demo`, `render`, `replay` and `rerender`
keys.py                    `pacinian keys`: CURVE keys for connections from other machines
status.py                  `pacinian status`: one state of the server
watch.py                   `pacinian watch`: states, live in a terminal
view.py                    `pacinian view`: the viewer in a browser
devices.py                 `pacinian devices`: list, check, draw, schema, udev rules
device_check_rules.py      what `devices check` says about a description and the connected devices
device_calibrate.py        `pacinian devices calibrate`: calibration from a microphone scan
device_calibrate_rules.py  what `devices calibrate` says about a scan and its fit
udev.py                    udev rules for USB arrays
plugins.py                 `pacinian plugins`: installed plug-ins
new.py                     `pacinian new`: package of a solver or backend from templates/
schema.py                  `pacinian schema`: JSON Schema of scene files
wire.py                    `pacinian wire`: documents of the protocol
options.py                 types of options: finite numbers, what must not be empty; the option `--connection`
console.py                 colours and width of a terminal, NO_COLOR
interrupts.py              Ctrl-C and SIGTERM, not lost in imports
standard_input.py          end of standard input: the parent has ended
templates/                 files of a new plug-in
"""
