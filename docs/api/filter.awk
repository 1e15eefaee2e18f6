# Shows doxygen a public header as it needs it: the first comment is that of the file; a line such as the next one begins a group; the
# first paragraph of a comment is its summary; and a struct without a name has that of its member, because members of the same name in
# different structs would be one otherwise.
# /* ---- Springs ---- */
{ line[NR] = $0 }
END {
    for (i = 1; i <= NR; i++) {
        if (i == 1 && line[i] == "/*") {
            name = FILENAME
            sub(/.*\//, "", name)
            line[i] = "/** @file " name "\n@brief"
        } else if (line[i] ~ /^\/\* ---- .* ---- \*\/$/) {
            gsub(/^\/\* ---- | ---- \*\/$/, "", line[i])
            line[i] = (grouped ? "/** @} */" : "") "/** @name " line[i] "\n@{ */"
            grouped = 1
        } else if (line[i] ~ /^#ifdef __cplusplus$/ && grouped) {
            line[i] = "/** @} */\n" line[i] # the end of extern "C"
            grouped = 0
        } else if (line[i] ~ /^ *struct [{]$/) {
            indent = line[i]
            sub(/struct.*/, "", indent)
            for (k = i; substr(line[k], 1, length(indent) + 2) != indent "} "; k++)
                ;
            name = line[k]
            gsub(/[ };]/, "", name)
            line[i] = indent "struct " name " {"
            about = "" # of the struct, and so of the member
            for (first = i - 1; line[first] !~ /\/\*\*/; first--)
                ;
            for (; first < i; first++) {
                text = line[first]
                sub(/^ *(\/\*\*|\*\/|\*)/, "", text)
                sub(/\*\/$/, "", text)
                sub(/ @brief/, "", text)
                about = about text
            }
            line[k] = line[k] " /**< @brief" about " */"
        } else if (line[i + 1] !~ /@(file|page)/)
            sub(/^ *\/\*\*/, "& @brief ", line[i])
        print line[i]
    }
}
