// Version of the build: for --version, and for reports.
#ifndef OB_CLI_VERSION_H
#define OB_CLI_VERSION_H

#include <stdio.h>

extern const char ob_version_number[];
extern const char ob_version_commit[]; // git commit, with + if files were modified; "unknown" outside of git
extern const char ob_version_words[]; // both in one: "0.1.0 (commit ...)"
void ob_version_print(FILE *f);

#endif
