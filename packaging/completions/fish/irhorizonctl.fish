# Print an optspec for argparse to handle cmd's options that are independent of any subcommand.
function __fish_irhorizonctl_global_optspecs
    string join \n bus= h/help V/version
end

function __fish_irhorizonctl_needs_command
    # Figure out if the current invocation already has a command.
    set -l cmd (commandline -opc)
    set -e cmd[1]
    argparse -s (__fish_irhorizonctl_global_optspecs) -- $cmd 2>/dev/null
    or return
    if set -q argv[1]
        # Also print the command, so this can be used to figure out what it is.
        echo $argv[1]
        return 1
    end
    return 0
end

function __fish_irhorizonctl_using_subcommand
    set -l cmd (__fish_irhorizonctl_needs_command)
    test -z "$cmd"
    and return 1
    contains -- $cmd[1] $argv
end

complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -s V -l version -d 'Print version'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "status" -d 'Say what the daemon says: attitude, mode, faults with their evidence'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "watch" -d 'Show the live horizon in the terminal (q to quit)'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "sensors" -d 'List the sensors: readings, states, checks, errors'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "doctor" -d 'Find out what is wrong with an installation, and what to do next'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "wait-ready" -d 'Wait until the daemon gives attitude'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "validate" -d 'Check a configuration file and its drop-ins'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "trim" -d 'Say the head\'s trim, with what was learnt in flight, as lines of configuration'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "calibrate" -d 'Measure what the head shows when level, or a pair when it sees no difference, and save it'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "set-address" -d 'Give the one MLX90614 on a bus another address'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "record" -d 'Record the daemon\'s frames, or the sensors\' without it, as CSV, until Ctrl-C'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "replay" -d 'Run a recording through the daemon\'s own estimator'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "simulate" -d 'Make up a recording: a flight under a scene, with its true attitude'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "score" -d 'Score methods of estimation against a recording\'s reference'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "plot" -d 'Draw a recording, its errors, or the report\'s figures as SVG'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "completions" -d 'Print a shell\'s completions of this command line'
complete -c irhorizonctl -n "__fish_irhorizonctl_needs_command" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand status" -l format -d 'How to say it' -r -f -a "plain\t'For people'
json\t'One JSON object'
prometheus\t'Prometheus text exposition'"
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand status" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand status" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand watch" -l size -d 'The picture\'s size in cells, WxH; the terminal\'s when not given' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand watch" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand watch" -l json -d 'Print a line of JSON for each update instead'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand watch" -l once -d 'Print one picture (or line of JSON) and end'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand watch" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand sensors" -l format -d 'How to say it' -r -f -a "plain\t'A table'
json\t'A JSON array'"
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand sensors" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand sensors" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand doctor" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand doctor" -l json -d 'One JSON object'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand doctor" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand wait-ready" -l timeout -d 'How long to wait; 0: one look' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand wait-ready" -l mode -d 'What counts as ready' -r -f -a "nominal\t'Attitude, and nothing wrong'
degraded\t'Attitude, be it degraded'"
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand wait-ready" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand wait-ready" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand validate" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand validate" -l show -d 'Print the configuration that results'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand validate" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand trim" -l save -d 'Write the lines to a file, such as /etc/irhorizon/irhorizon.toml.d/50-trim.toml' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand trim" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand trim" -l force -d 'Overwrite the file when it is there already'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand trim" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -l config -d 'The configuration whose drop-ins it is saved among' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -l seconds -d 'How long to average' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -l dry-run -d 'Say what would be saved, and save nothing'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -l undo -d 'Bring back what held before the last one'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -l yes -d 'Ask nothing'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand calibrate" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand set-address" -l i2c-bus -d 'The bus that it is on, alone among MLX90614' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand set-address" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand set-address" -l yes -d 'Ask nothing'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand set-address" -l no-read-pec -d 'Do not check what is read: for a part that is known to send a wrong PEC'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand set-address" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand record" -l seconds -d 'End after this many seconds' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand record" -l config -d 'The configuration that --offline goes by' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand record" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand record" -l force -d 'Overwrite the file when it is there already'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand record" -l offline -d 'Read the sensors without the daemon, which must not be reading them'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand record" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand replay" -l config -d 'The configuration; the recording\'s own when not given, or else the six directions' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand replay" -l output -d 'Where the estimates go; standard output when not given' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand replay" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand replay" -l no-aiding -d 'Use the thermopiles alone'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand replay" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l seed -d 'What chance decides: the same seed, the same recording' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l seconds -d 'How long, up to 7200' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l rate -d 'Scans a second, 1 to 200' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l fault -d 'What goes wrong, such as wet:nose@10..40 (s); again for more; the kinds are with --list' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l output -d 'Where the recording goes; standard output when not given' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l list -d 'Say what the scenarios are'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l scripted -d 'Fly the demonstration\'s script instead of turns by chance; inverted and aerobatics fly their own anyway'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l no-aiding -d 'Leave out gyro, GPS and airspeed'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -l differential -d 'Three pairs in volts instead of six temperatures'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand simulate" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l config -d 'The configuration; the recording\'s own when not given, or else the six directions' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l method -d 'A method, or all that the head allows; may be given again; the configured one when not given' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l beside -d 'Estimates of another program to score beside, with replay\'s columns; may be given again' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l skip -d 'Leave out the first seconds' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l min-ground-speed -d 'Leave out rows at this ground speed or below, m/s, and those before one is known' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l format -d 'How to say it' -r -f -a "plain\t'A table'
json\t'One JSON object'"
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -l no-aiding -d 'Use the thermopiles alone'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand score" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and not __fish_seen_subcommand_from flight residuals report help" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and not __fish_seen_subcommand_from flight residuals report help" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and not __fish_seen_subcommand_from flight residuals report help" -f -a "flight" -d 'A flight over time: roll, pitch, contrast, mode, faults'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and not __fish_seen_subcommand_from flight residuals report help" -f -a "residuals" -d 'The errors of roll and pitch against the reference'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and not __fish_seen_subcommand_from flight residuals report help" -f -a "report" -d 'Figures 6 to 9 of the report MECSE-2-2007, from this program\'s own sky'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and not __fish_seen_subcommand_from flight residuals report help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l config -d 'The configuration; the recording\'s own when not given, or else the six directions' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l method -d 'The method; the configured one when not given' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l output -d 'Where the drawing goes; standard output when not given' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l from -d 'Begin at this time of the recording, s' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l to -d 'End at this time of the recording, s' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -l no-aiding -d 'Use the thermopiles alone'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from flight" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l config -d 'The configuration; the recording\'s own when not given, or else the six directions' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l method -d 'The method; the configured one when not given' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l output -d 'Where the drawing goes; standard output when not given' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l from -d 'Begin at this time of the recording, s' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l to -d 'End at this time of the recording, s' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -l no-aiding -d 'Use the thermopiles alone'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from residuals" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from report" -l output-dir -d 'Where figure-6.svg to figure-9.svg go' -r -F
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from report" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from report" -s h -l help -d 'Print help'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from help" -f -a "flight" -d 'A flight over time: roll, pitch, contrast, mode, faults'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from help" -f -a "residuals" -d 'The errors of roll and pitch against the reference'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from help" -f -a "report" -d 'Figures 6 to 9 of the report MECSE-2-2007, from this program\'s own sky'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand plot; and __fish_seen_subcommand_from help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand completions" -l bus -d 'The D-Bus bus the daemon is on: system, session, or an address such as unix:path=/run/bus' -r
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand completions" -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "status" -d 'Say what the daemon says: attitude, mode, faults with their evidence'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "watch" -d 'Show the live horizon in the terminal (q to quit)'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "sensors" -d 'List the sensors: readings, states, checks, errors'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "doctor" -d 'Find out what is wrong with an installation, and what to do next'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "wait-ready" -d 'Wait until the daemon gives attitude'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "validate" -d 'Check a configuration file and its drop-ins'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "trim" -d 'Say the head\'s trim, with what was learnt in flight, as lines of configuration'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "calibrate" -d 'Measure what the head shows when level, or a pair when it sees no difference, and save it'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "set-address" -d 'Give the one MLX90614 on a bus another address'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "record" -d 'Record the daemon\'s frames, or the sensors\' without it, as CSV, until Ctrl-C'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "replay" -d 'Run a recording through the daemon\'s own estimator'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "simulate" -d 'Make up a recording: a flight under a scene, with its true attitude'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "score" -d 'Score methods of estimation against a recording\'s reference'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "plot" -d 'Draw a recording, its errors, or the report\'s figures as SVG'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "completions" -d 'Print a shell\'s completions of this command line'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and not __fish_seen_subcommand_from status watch sensors doctor wait-ready validate trim calibrate set-address record replay simulate score plot completions help" -f -a "help" -d 'Print this message or the help of the given subcommand(s)'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and __fish_seen_subcommand_from plot" -f -a "flight" -d 'A flight over time: roll, pitch, contrast, mode, faults'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and __fish_seen_subcommand_from plot" -f -a "residuals" -d 'The errors of roll and pitch against the reference'
complete -c irhorizonctl -n "__fish_irhorizonctl_using_subcommand help; and __fish_seen_subcommand_from plot" -f -a "report" -d 'Figures 6 to 9 of the report MECSE-2-2007, from this program\'s own sky'
