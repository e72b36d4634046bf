complete -c irhorizond -s c -l config -d 'The configuration; drop-ins are read from FILE.d/*.toml' -r -F
complete -c irhorizond -l log-level -d 'How much is logged' -r -f -a "error\t'What must be acted on'
warn\t'And what should be looked at'
info\t'And what happened'
debug\t'And how'"
complete -c irhorizond -s h -l help -d 'Print help (see more with \'--help\')'
complete -c irhorizond -s V -l version -d 'Print version'
