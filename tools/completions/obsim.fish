# fish completion for obsim

function __obsim_cases
	obsim lab --list 2>/dev/null | string match -rg '^ *\d+ +(\S+) '
end

function __obsim_universes
	for path in /dev/shm/obsim.*
		string replace /dev/shm/obsim. '' -- $path
	end
end

complete -c obsim -f
complete -c obsim -n __fish_use_subcommand -a run -d 'run a scene and report'
complete -c obsim -n __fish_use_subcommand -a serve -d 'run a scene that people look at'
complete -c obsim -n __fish_use_subcommand -a export -d 'make a page of what was recorded'
complete -c obsim -n __fish_use_subcommand -a compare -d 'run a scene in all configurations'
complete -c obsim -n __fish_use_subcommand -a top -d 'look into a running universe'
complete -c obsim -n __fish_use_subcommand -a lab -d 'run hard cases with several engines'
complete -c obsim -n __fish_use_subcommand -a paper -d 'run the paper again and judge its claims'
complete -c obsim -n __fish_use_subcommand -a send -d 'ask a running universe for something'
complete -c obsim -n __fish_use_subcommand -a inspect -d 'say what a checkpoint holds'
complete -c obsim -n __fish_use_subcommand -a help -d 'help of a command'
complete -c obsim -n __fish_use_subcommand -l version -d 'version, commit, libraries'
complete -c obsim -s h -l help -d 'print help'
complete -c obsim -n '__fish_seen_subcommand_from help' -a 'run serve export compare top send inspect lab paper'

set -l both '__fish_seen_subcommand_from run compare serve'
complete -c obsim -n $both -a '(__fish_complete_suffix .lua)'
complete -c obsim -n $both -s D -l define -x -d 'set a parameter of the scene'
complete -c obsim -n $both -l duration -x -d 'simulated seconds'
complete -c obsim -n $both -l step -x -d 'seconds a step'
complete -c obsim -n $both -l seed -x -d 'seed of random numbers'
complete -c obsim -n $both -l workers -x -a 'objects 1 2 4 8' -d 'workers in the pool, or one for each object'
complete -c obsim -n $both -l tolerance -x -a '5mm .5mm .05mm' -d 'error that objects that touch may reach'
complete -c obsim -n $both -l substeps -x -d 'substeps a step'
complete -c obsim -n $both -l iterations -x -d 'of the contact solver a substep'
complete -c obsim -n $both -l solver -x -a 'coloured jacobi ghost lagged' -d 'how contacts are solved'
complete -c obsim -n $both -l harden -a 'outbox checksum pages privileges limits calls' -d 'processes that write their own results alone'
complete -c obsim -n $both -l lag -x -d 'lagged: iterations that a state is late'
complete -c obsim -n $both -l integrator -x -a 'exact ode' -d 'free motion'
complete -c obsim -n $both -l sleeping -x -a 'on off' -d 'whether what rests may sleep'
complete -c obsim -n $both -l narrow -x -a 'obb aabb' -d 'what touches'
complete -c obsim -n $both -l load -x -d 'numbers added up in each box test'

set -l lives '__fish_seen_subcommand_from run serve'
complete -c obsim -n $lives -l arch -x -a 'obs monolith' -d 'one simulator per object, or one world'
complete -c obsim -n $lives -l check -d 'check what simulators share after each step'
complete -c obsim -n $lives -l isolation -x -a 'thread process' -d 'what a worker is'
complete -c obsim -n $lives -l name -x -d 'name of the universe'
complete -c obsim -n $lives -l patience -x -d 'seconds that a step may take'
complete -c obsim -n $lives -l on-death -x -a 'restart freeze abort keep' -d 'what comes of a death'
complete -c obsim -n $lives -l restarts -x -a '5/10' -d 'deaths within seconds'
complete -c obsim -n $lives -l pace -x -a 'realtime max .1 10' -d 'simulated seconds a second of the clock'

set -l serve '__fish_seen_subcommand_from serve'
complete -c obsim -n $serve -l listen -x -a '127.0.0.1:8080 127.0.0.1:0' -d 'where viewers come to'
complete -c obsim -n $serve -l paused -d 'stand still until a viewer lets it run'
complete -c obsim -n $serve -l readonly -d 'viewers may look, and change nothing'
complete -c obsim -n $serve -l viewers -x -d 'viewers at a time'
complete -c obsim -n $serve -l room -x -d 'objects that viewers may add'
complete -c obsim -n $serve -l replay -r -F -d 'show what was recorded'
complete -c obsim -n '__fish_seen_subcommand_from export' -F

set -l run '__fish_seen_subcommand_from run'
complete -c obsim -n '__fish_seen_subcommand_from run compare' -l json -r -F -d 'the report as JSON'
complete -c obsim -n $run -l explain -d 'what was modelled, what not, and what it cost'
complete -c obsim -n $run -l trace -r -F -d 'what each worker did when, for ui.perfetto.dev'
complete -c obsim -n $run -l checkpoint -r -F -d 'what the run needs to go on'
complete -c obsim -n $run -l every -x -d 'simulated seconds between checkpoints'
complete -c obsim -n $run -l resume -r -F -d 'go on from a checkpoint'
complete -c obsim -n $run -l fault -x -a 'kill:p= segv:p= exit:p= stop:p= slow:p= scribble:p= nospace:p= nopages:p= abort:p=' -d 'simulators that fail'
complete -c obsim -n $run -l frames -x -a '(__fish_complete_directories)' -d 'write PNG files'
complete -c obsim -n $run -l video -r -F -d 'write a video'
complete -c obsim -n $run -l raw -r -F -d 'write raw rgb24 frames'
complete -c obsim -n $run -l fps -x -d 'frames per simulated second'
complete -c obsim -n $run -l size -x -a '640x480 1280x720 1920x1080' -d pixels
complete -c obsim -n $run -l quality -x -a 'draft fine' -d 'of pictures'
complete -c obsim -n $run -l samples -x -a '1 2 4 8 16 64' -d 'samples a pixel'
complete -c obsim -n $run -l camera -x -d 'which camera'
complete -c obsim -n $run -l overlay -x -a 'aabb contacts caption aabb,contacts' -d 'draw over it'
complete -c obsim -n $run -l gpu -x -a 'surfaceless 0 1' -d 'which GPU'
complete -c obsim -n $run -l record -r -F -d 'trajectories as HDF5'
complete -c obsim -n $run -l replay -r -F -d 'draw what was recorded'
complete -c obsim -n $run -l series -r -F -d 'figures of each step as CSV'
complete -c obsim -n $run -l strict -d 'fail where the tolerance is missed'
complete -c obsim -n $run -l measure -x -a 'step profile end' -d 'when to measure'

set -l compare '__fish_seen_subcommand_from compare'
set -l top '__fish_seen_subcommand_from top'
complete -c obsim -n $top -a '(__obsim_universes)'
complete -c obsim -n $top -l once -d 'print once and end'
complete -c obsim -n $top -l interval -x -d 'seconds between looks'

set -l lab '__fish_seen_subcommand_from lab'
complete -c obsim -n $lab -a '(__obsim_cases)'
complete -c obsim -n $lab -l list -d 'print the cases and end'
complete -c obsim -n $lab -l quick -d 'only the quick subset'
complete -c obsim -n $lab -l engines -x -d 'engines, with commas' \
	-a 'all obsim obsim-jacobi obsim-ode obsim-ghost obsim-lag ode-quick ode-advised ode-world bullet mujoco'
complete -c obsim -n $lab -l sweep -x -a 'none substeps= iterations= tolerance= lag=' -d 'settings'
complete -c obsim -n $compare -l vary -x -d 'compare at each of these values'
complete -c obsim -n $compare -l repeats -x -d 'runs of each'
complete -c obsim -n $compare -l seeds -x -d 'seeds, repeats of each'
complete -c obsim -n $compare -l fresh -d 'run again what is there already'
complete -c obsim -n $compare -l out -x -a '(__fish_complete_directories)' -d 'results, diagrams, report'
complete -c obsim -n $lab -l audit -d 'whether errors fall with tolerance and substeps'
complete -c obsim -n $lab -l repeats -x -d 'runs of each'
complete -c obsim -n $lab -l limit -x -d 'seconds that a run may take'
complete -c obsim -n $lab -l out -x -a '(__fish_complete_directories)' -d 'results, diagrams, report'
complete -c obsim -n $lab -l fresh -d 'run again what is there already'
complete -c obsim -n $lab -l json -d 'print the results as JSON'
complete -c obsim -n $lab -l check -d 'exit with 3 when a target is missed'

set -l paper '__fish_seen_subcommand_from paper'
complete -c obsim -n $paper -l quick -d 'few and short runs'
complete -c obsim -n $paper -l objects -x -d 'boxes in each experiment'
complete -c obsim -n $paper -l repeats -x -d 'experiments of each scenario'
complete -c obsim -n $paper -l fresh -d 'run again what is there already'
complete -c obsim -n $paper -l out -x -a '(__fish_complete_directories)' -d 'tables, diagrams, report'
complete -c obsim -n $paper -l json -d 'print the results as JSON'

set -l inspect '__fish_seen_subcommand_from inspect'
complete -c obsim -n $inspect -F
complete -c obsim -n $inspect -l json -d 'print it as JSON'

set -l send '__fish_seen_subcommand_from send'
complete -c obsim -n $send -a 'create remove colour message move'
