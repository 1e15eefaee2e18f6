# completion.zsh FOLDER <LINES: in an interactive zsh with the completions of FOLDER, types each line and the Tab key. Prints the line,
# and below it a row for each word that can complete it: the word, a tab, and what zsh shows.
zmodload zsh/zpty || exit 77
folder=$1
zpty inner zsh -f -i
# take UNTIL: prints what the inner shell writes, up to a line that is UNTIL
take() {
    local text all=
    while zpty -r inner text; do
        all+=$text
        [[ $all == *$1* ]] && break
    done
    print -r -- "$all"
}
zpty -w inner "PROMPT= RPROMPT= PS2= LISTMAX=0; unsetopt zle_bracketed_paste 2>/dev/null; stty -echo; COLUMNS=400; fpath=($folder \$fpath); autoload -Uz compinit; compinit -u -D
zstyle ':completion:*' verbose yes
# Shows the words and their texts instead of adding them.
compadd() {
    if [[ \${@[1,(i)(-|--)]} == *-(O|A|D)\ * ]]; then
        builtin compadd \"\$@\"
        return
    fi
    local -a hits texts options
    local shown=\${@[(I)-d]}
    [[ \$shown == 0 ]] || texts=(\${(P)@[shown + 1]})
    builtin compadd -A hits -D texts \"\$@\"
    local i
    for ((i = 1; i <= \$#hits; i++)); do
        print -r -- \"row \$IPREFIX\${hits[i]}\"\$'\\t'\"\${texts[i]}\"
    done
    builtin compadd \"\$@\"
}
show() { print; _main_complete; compstate[list]= compstate[insert]=; print end_of_words; zle kill-buffer 2>/dev/null }
zle -C show complete-word show
clear_line() { BUFFER= }
zle -N clear_line
bindkey '^I' show '^U' clear_line
print ready''to"
take readyto >/dev/null
while IFS= read -r line; do
    zpty -w -n inner $'\025'"$line"$'\t'
    print -r -- "$line"
    take end_of_words | tr -d '\r' | sed -n 's/^row //p'
done
zpty -d inner
