// Messages for the person at the terminal, on standard error, one line each. Thread-safe; fork-safe.
#ifndef OB_BASE_LOG_H
#define OB_BASE_LOG_H

void ob_log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void ob_log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void ob_log_note(const char *format, ...) __attribute__((format(printf, 1, 2)));
// false silences notes (the others stay)
void ob_log_set_notes(int on);

#endif
