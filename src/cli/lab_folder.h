// The folder in which the lab keeps what it measures, and writes what it makes of it.
#ifndef OB_CLI_LAB_FOLDER_H
#define OB_CLI_LAB_FOLDER_H

#include "lab/result.h"

// The path of a file in the folder, malloc'd; ends the program when there is no memory for it.
char *ob_lab_folder_path(const char *folder, const char *name);
// Makes the folder of --out, with all above it: like mkdir -p.
bool ob_lab_folder_make(const char *folder, ob_error *e);
// Makes the folder and reads the results that this program has left there on this machine. Those of
// another get a file of their own, and it is said so. false and e: nothing can be kept there.
bool ob_lab_folder_open(const char *folder, ob_results *r, ob_error *e);
// Tables, diagrams and the report.
bool ob_lab_folder_write(const char *folder, const ob_results *r, ob_error *e);

#endif
