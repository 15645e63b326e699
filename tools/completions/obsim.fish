# fish completion for obsim

function __obsim_cases
	obsim lab --list 2>/dev/null | string match -rg '^ *\d+ +(\S+) '
end

# name= and, of a choice, name=value
function __obsim_settings
	echo help
	for one in (obsim (commandline -opc)[2] --set help 2>/dev/null | string match -rg '^  ([a-z_]+=\S+)')
		set -l parts (string split = $one)
		string match -qr '[A-Z]' $parts[2]; and echo $parts[1]=; or printf "$parts[1]=%s\n" (string split '|' $parts[2])
	end
end

function __obsim_universes
	for path in /dev/shm/obsim.*
		string replace /dev/shm/obsim. '' -- $path
	end
end

complete -c obsim -f
complete -c obsim -n __fish_use_subcommand -a run -d 'run a scene and report'
complete -c obsim -n __fish_use_subcommand -a serve -d 'run a scene that people look at'
complete -c obsim -n __fish_use_subcommand -a control -d 'run a scene that a program leads'
complete -c obsim -n __fish_use_subcommand -a import -d 'make a scene of a robot'
complete -c obsim -n __fish_use_subcommand -a export -d 'make a page of what was recorded'
complete -c obsim -n __fish_use_subcommand -a compare -d 'run a scene in all configurations'
complete -c obsim -n __fish_use_subcommand -a top -d 'look into a running universe'
complete -c obsim -n __fish_use_subcommand -a lab -d 'run hard cases with several engines'
complete -c obsim -n __fish_use_subcommand -a paper -d 'run the paper again and judge its claims'
complete -c obsim -n __fish_use_subcommand -a send -d 'ask a running universe for something'
complete -c obsim -n __fish_use_subcommand -a inspect -d 'say what a checkpoint holds'
complete -c obsim -n __fish_use_subcommand -a scenes -d 'list the scenes that come with obsim'
complete -c obsim -n __fish_use_subcommand -a help -d 'help of a command'
complete -c obsim -n __fish_use_subcommand -l version -d 'version, commit, libraries'
complete -c obsim -s h -l help -d 'print help'
complete -c obsim -n '__fish_seen_subcommand_from help' -a 'run serve control export compare top send inspect lab paper scenes import'

set -l both '__fish_seen_subcommand_from run compare serve control'
complete -c obsim -n $both -a '(__fish_complete_suffix .lua)'
complete -c obsim -n $both -s D -l define -x -d 'set a parameter of the scene'
complete -c obsim -n $both -l duration -x -d 'simulated seconds'
complete -c obsim -n $both -l step -x -d 'seconds a step'
complete -c obsim -n $both -l seed -x -d 'seed of random numbers'
complete -c obsim -n $both -l set -x -a '(__obsim_settings)' -d 'set what experiments vary'
complete -c obsim -n $both -l workers -x -a 'objects 1 2 4 8' -d 'workers in the pool, or one for each object'
complete -c obsim -n $both -l tolerance -x -a '5mm .5mm .05mm' -d 'error that objects that touch may reach'
complete -c obsim -n $both -l harden -a 'outbox checksum pages privileges limits calls' -d 'processes that write their own results alone'

set -l lives '__fish_seen_subcommand_from run serve control'
complete -c obsim -n $lives -l arch -x -a 'obs monolith' -d 'one simulator per object, or one world'
complete -c obsim -n $lives -l check -d 'check what simulators share after each step'
complete -c obsim -n $lives -l isolation -x -a 'thread process' -d 'what a worker is'
complete -c obsim -n $lives -l name -x -d 'name of the universe'
complete -c obsim -n $lives -l on-death -x -a 'restart freeze abort keep' -d 'what comes of a death'
complete -c obsim -n '__fish_seen_subcommand_from run serve' -l pace -x -a 'realtime max .1 10' -d 'simulated seconds a second of the clock'

set -l serve '__fish_seen_subcommand_from serve'
complete -c obsim -n '__fish_seen_subcommand_from serve compare' -l listen -x -a '127.0.0.1:8080 127.0.0.1:0' -d 'where viewers come to'
complete -c obsim -n $serve -l paused -d 'stand still until a viewer lets it run'
complete -c obsim -n $serve -l foxglove -d 'speak the live protocol of Foxglove'
complete -c obsim -n $serve -l readonly -d 'viewers may look, and change nothing'
complete -c obsim -n $serve -l viewers -x -d 'viewers at a time'
complete -c obsim -n $serve -l log-requests -r -F -d 'what viewers ask for, and the state'
complete -c obsim -n '__fish_seen_subcommand_from serve control' -l room -x -d 'objects that viewers may add'
complete -c obsim -n '__fish_seen_subcommand_from control' -l record -r -F -d 'trajectories as HDF5'
complete -c obsim -n $serve -l record -r -F -d 'record what is served'
complete -c obsim -n $serve -l replay -r -F -d 'show what was recorded'
complete -c obsim -n '__fish_seen_subcommand_from import' -F
complete -c obsim -n '__fish_seen_subcommand_from import' -l out -x -a '(__fish_complete_directories)' -d 'where scene and looks go'
complete -c obsim -n '__fish_seen_subcommand_from export' -F
complete -c obsim -n '__fish_seen_subcommand_from export' -l patience -x -d 'seconds of CPU for the page'

set -l run '__fish_seen_subcommand_from run'
complete -c obsim -n $run -l sync -x -a 'lockstep free' -d 'step together or at own times'
complete -c obsim -n '__fish_seen_subcommand_from compare' -l sync -x -a 'lockstep,free' -d 'compare lockstep with free running'
complete -c obsim -n '__fish_seen_subcommand_from run compare' -l json -r -F -d 'the report as JSON'
complete -c obsim -n $run -l report -x -a 'short full' -d 'five lines, or all that was measured'
complete -c obsim -n $run -l explain -d 'what was modelled, what not, and what it cost'
complete -c obsim -n $run -l trace -r -F -d 'what each worker did when, for ui.perfetto.dev'
complete -c obsim -n $run -l checkpoint -r -F -d 'what the run needs to go on'
complete -c obsim -n $run -l replay-requests -r -F -d 'carry out what serve has logged'
complete -c obsim -n '__fish_seen_subcommand_from run control' -l resume -r -F -d 'go on from a checkpoint'
complete -c obsim -n $run -l fault -x -a 'kill:p= segv:p= exit:p= stop:p= slow:p= scribble:p= nospace:p= nopages:p= abort:p=' -d 'simulators that fail'
complete -c obsim -n $run -l out -r -F -d 'PNG frames into a folder, a video, raw rgb24 frames'
complete -c obsim -n $run -l fps -x -d 'frames per simulated second'
complete -c obsim -n $run -l still -x -d 'frames of these times alone'
complete -c obsim -n $run -l size -x -a '640x480 1280x720 1920x1080' -d pixels
complete -c obsim -n $run -l quality -x -a 'draft fine' -d 'of pictures'
complete -c obsim -n $run -l camera -x -d 'which camera'
complete -c obsim -n $run -l overlay -x -a 'aabb contacts joints reads simulators caption aabb,contacts' -d 'draw over it'
complete -c obsim -n $run -l colour-by -x -a 'own simulator worker process rank island rest cost lag' -d 'colour objects by who simulates them'
complete -c obsim -n $run -l record -r -F -d 'trajectories as HDF5'
complete -c obsim -n $run -l replay -r -F -d 'draw what was recorded'
complete -c obsim -n $run -l series -r -F -d 'figures of each step as CSV'
complete -c obsim -n $run -l strict -d 'fail where the tolerance is missed, or a script fails'

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
complete -c obsim -n $compare -l live -d 'architectures side by side on one page'
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
complete -c obsim -n $send -a '(obsim help send 2>/dev/null | sed -n "s/^  obsim send NAME \([a-z]*\).*/\1/p")'
