# zsh_offers.zsh FOLDER <LINES: what zsh offers at the end of each line, by the completion FOLDER/_nocturne, a line each.
# A shell of its own sits on a pseudo-terminal, gets the line and a tab, and keeps what the completion hands to it.
zmodload zsh/zpty || exit 1
folder=$1 found=$1/zsh-found
zpty shell env TERM=dumb HOME=$folder zsh -f -i
zpty -w shell "PS1= fpath=($folder \$fpath) found=$found"
zpty -w shell "autoload -Uz compinit; compinit -u -D"
zpty -w shell 'compadd() {
    if [[ " ${@[1,(i)(-|--)]} " == *" -"[OAD]" "* ]]; then builtin compadd "$@"; return; fi
    local -a hits
    builtin compadd -A hits "$@"
    print -rl -- $hits >>$found
    builtin compadd "$@"
}'
zpty -w shell 'ended() { print -r -- "# end" >>$found; }; unsetopt auto_list beep; print ready >$found'
wait_for() {
    for (( i = 0; i < 6000; i++ )); do
        while zpty -rt shell shown; do :; done # or it would wait for its output to be read
        grep -qx $1 $found 2>/dev/null && return
        sleep 0.02
    done
    return 1
}
wait_for ready || exit 1
while IFS= read -r line; do
    : >$found
    zpty -w shell 'comppostfuncs=(ended)'
    zpty -w -n shell "$line"$'\t'
    wait_for '# end' || exit 1
    grep -v '^# end$' $found | sed '/^$/d' | sort -u | tr '\n' ' '
    echo
    zpty -w -n shell $'\C-u'
done
zpty -d shell
