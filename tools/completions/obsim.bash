# bash completion for obsim
# The options come from the program itself, so that they are always those of the version installed.

_obsim_options()
{
	"$1" help "$2" 2>/dev/null | sed -n 's/^  .*\(--[a-z][a-z-]*\).*/\1/p' | sed 's/ .*//'
}

_obsim_requests()
{
	"$1" help send 2>/dev/null | sed -n 's/^  obsim send NAME \([a-z]*\).*/\1/p'
}

# name= and, of a choice, name=value
_obsim_settings()
{
	"$1" "$2" --set help 2>/dev/null | sed -n 's/^  \([a-z_]*=[^ ]*\).*/\1/p' |
		awk -F= '$2 ~ /[A-Z]/ { print $1 "="; next } { n = split($2, v, "|"); for (i = 1; i <= n; i++) print $1 "=" v[i] }'
}

_obsim()
{
	local program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} word=${COMP_WORDS[COMP_CWORD]}
	local previous=${COMP_WORDS[COMP_CWORD - 1]} set=
	[[ $previous == = ]] && set=${COMP_WORDS[COMP_CWORD - 2]}= previous=${COMP_WORDS[COMP_CWORD - 3]} # bash parts words at =
	COMPREPLY=()
	[[ $command:$previous == @(lab|paper|inspect):--json ]] && previous= # a flag there
	if ((COMP_CWORD == 1)); then
		mapfile -t COMPREPLY < <(compgen -W 'run serve control export compare top send inspect lab paper scenes import help --help --version' -- "$word")
		return
	fi
	case $previous in
	--arch) mapfile -t COMPREPLY < <(compgen -W 'obs monolith' -- "$word") ;;
	--isolation) mapfile -t COMPREPLY < <(compgen -W 'thread process' -- "$word") ;;
	--workers) mapfile -t COMPREPLY < <(compgen -W 'objects 1 2 4 8' -- "$word") ;;
	--tolerance) mapfile -t COMPREPLY < <(compgen -W '5mm .5mm .05mm' -- "$word") ;;
	--on-death) mapfile -t COMPREPLY < <(compgen -W 'restart freeze abort keep' -- "$word") ;;
	--pace) mapfile -t COMPREPLY < <(compgen -W 'realtime max .1 10' -- "$word") ;;
	--set) mapfile -t COMPREPLY < <(compgen -W "help $(_obsim_settings "$program" "$command")" -- "$set$word") && COMPREPLY=("${COMPREPLY[@]#"$set"}") ;;
	--sync) mapfile -t COMPREPLY < <(compgen -W 'lockstep free lockstep,free' -- "$word") ;;
	--quality) mapfile -t COMPREPLY < <(compgen -W 'draft fine' -- "$word") ;;
	--overlay) mapfile -t COMPREPLY < <(compgen -W 'aabb contacts joints reads simulators caption aabb,contacts' -- "$word") ;;
	--colour-by) mapfile -t COMPREPLY < <(compgen -W 'own simulator worker process rank island rest cost lag' -- "$word") ;;
	--size) mapfile -t COMPREPLY < <(compgen -W '640x480 1280x720 1920x1080' -- "$word") ;;
	--engines) mapfile -t COMPREPLY < <(compgen -W 'all obsim obsim-jacobi obsim-ode obsim-ghost obsim-lag ode-quick
		ode-advised ode-world bullet mujoco' -- "$word") ;;
	--sweep) mapfile -t COMPREPLY < <(compgen -W 'none substeps= iterations= tolerance= lag=' -- "$word") ;;
	--fault) mapfile -t COMPREPLY < <(compgen -W 'kill:p= segv:p= exit:p= stop:p= slow:p= scribble:p= nospace:p= nopages:p= abort:p=' -- "$word") ;;
	--out | --record | --series | --json | --trace | --checkpoint | --resume | --replay | --log-requests | --replay-requests) mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
	--define | -D | --vary | --duration | --step | --seed | --patience | --name | --fps | --still | \
		--camera | --interval | --repeats | --seeds | --limit | --objects) ;;
	*)
		case $command:$word in
		help:*) mapfile -t COMPREPLY < <(compgen -W 'run serve control export compare top send inspect lab paper scenes import' -- "$word") ;;
		*:-*) mapfile -t COMPREPLY < <(compgen -W "$(_obsim_options "$program" "$command")" -- "$word") ;;
		paper:*) ;;
		inspect:* | export:* | import:*) mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
		send:*) mapfile -t COMPREPLY < <(compgen -W "$(_obsim_requests "$program") $(cd /dev/shm 2>/dev/null && printf '%s\n' obsim.* |
			sed -n 's/^obsim\.\([^*]\)/\1/p')" -- "$word") ;;
		top:*) mapfile -t COMPREPLY < <(compgen -W "$(cd /dev/shm 2>/dev/null && printf '%s\n' obsim.* |
			sed -n 's/^obsim\.\([^*]\)/\1/p')" -- "$word") ;;
		lab:*) mapfile -t COMPREPLY < <(compgen -W "$("$program" lab --list 2>/dev/null |
			sed -n 's/^ *[0-9]* *\([^ ]*\) .*/\1/p')" -- "$word"
			compgen -f -X '!*.lua' -- "$word") ;;
		*) mapfile -t COMPREPLY < <(compgen -d -S / -- "$word"
			compgen -f -X '!*.lua' -- "$word") ;;
		esac
		;;
	esac
}

complete -o filenames -o nosort -F _obsim obsim
