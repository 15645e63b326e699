#include "host/confine.h"

#include <errno.h>
#include <grp.h>
#include <linux/sched.h>
#include <linux/audit.h>
#include <linux/capability.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/sanitizer.h"
#include "table/desk.h"
#include "table/outbox.h"

enum { NOBODY = 65534, FILES = STDERR_FILENO + 1 };

#if defined(__x86_64__)
#define MACHINE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define MACHINE AUDIT_ARCH_AARCH64
#endif

// ---- root

static bool gain_no_more(void)
{
	return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
}

// Drops root. A change of user resets the parent-death signal, so it is set again.
static bool drop_root(void)
{
	const pid_t parent = getppid();
	struct __user_cap_header_struct head = { .version = _LINUX_CAPABILITY_VERSION_3 };
	struct __user_cap_data_struct none[2] = { { 0 } };
	if (!gain_no_more())
		return false;
	if (geteuid() == 0 && (setgroups(0, NULL) != 0 || setresgid(NOBODY, NOBODY, NOBODY) != 0 ||
			       setresuid(NOBODY, NOBODY, NOBODY) != 0))
		return false;
	if (syscall(SYS_capset, &head, none) != 0 || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0)
		return false;
	if (getppid() != parent)
		_exit(EXIT_FAILURE); // the parent died in the meantime
	return true;
}

// ---- resources

static bool limit(int resource, rlim_t most)
{
	struct rlimit now;
	if (getrlimit((__rlimit_resource_t)resource, &now) != 0)
		return false;
	most = most < now.rlim_max ? most : now.rlim_max;
	return setrlimit((__rlimit_resource_t)resource, &(struct rlimit){ most, most }) == 0;
}

static bool limit_memory(void)
{
	const rlim_t memory = (rlim_t)sysconf(_SC_PHYS_PAGES) / 2 * (rlim_t)sysconf(_SC_PAGESIZE);
	return limit(RLIMIT_CORE, 0) &&
	       (OB_SANITIZED || limit(RLIMIT_DATA, memory)); // a sanitizer needs memory of its own
}

static bool limit_resources(void)
{
	return limit_memory() && limit(RLIMIT_NPROC, 0) && limit(RLIMIT_NOFILE, FILES) && limit(RLIMIT_MEMLOCK, 0) &&
	       limit(RLIMIT_MSGQUEUE, 0);
}

// ---- system calls

#ifdef MACHINE
#define LOAD(field) BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)offsetof(struct seccomp_data, field))
#define ARGUMENT(i) LOAD(args[i]) // its lower half: these machines are little-endian
#define RETURN(what) BPF_STMT(BPF_RET | BPF_K, what)
#define ALLOW(call) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_##call, 0, 1), RETURN(SECCOMP_RET_ALLOW)
// Allow a call only with this value of an argument, or with none of these bits set in it. Other arguments kill the
// process.
#define ALLOW_WITH(call, i, value) \
	BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_##call, 0, 4), ARGUMENT(i), \
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1), RETURN(SECCOMP_RET_ALLOW), \
		RETURN(SECCOMP_RET_KILL_PROCESS)
#define ALLOW_WITHOUT(call, i, bits) \
	BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_##call, 0, 4), ARGUMENT(i), \
		BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, bits, 1, 0), RETURN(SECCOMP_RET_ALLOW), \
		RETURN(SECCOMP_RET_KILL_PROCESS)
// Allow a call only with values of an argument up to this one.
#define ALLOW_UP_TO(call, i, most) \
	BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_##call, 0, 4), ARGUMENT(i), \
		BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, most, 1, 0), RETURN(SECCOMP_RET_ALLOW), \
		RETURN(SECCOMP_RET_KILL_PROCESS)
#define REFUSE(call, how) BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_##call, 0, 1), RETURN(how)

static bool install(struct sock_filter *code, size_t n)
{
	const struct sock_fprog program = { .len = (unsigned short)n, .filter = code };
	return gain_no_more() && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

static bool filter_system_calls(void)
{
	const uint32_t self = (uint32_t)getpid();
	struct sock_filter code[] = {
		LOAD(arch),
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, MACHINE, 1, 0),
		RETURN(SECCOMP_RET_KILL_PROCESS),
		LOAD(nr),
		// waiting, clocks
		ALLOW(futex),
		ALLOW(sched_yield),
		ALLOW(clock_gettime),
		ALLOW(clock_nanosleep),
		ALLOW(nanosleep),
		ALLOW(gettimeofday),
		ALLOW(restart_syscall),
		// memory, without execution
		ALLOW(brk),
		ALLOW(munmap),
		ALLOW(mremap),
		ALLOW(madvise),
		ALLOW(getrandom),
		ALLOW(sysinfo), // qsort() reads the size of memory
		ALLOW_WITHOUT(mmap, 2, PROT_EXEC),
		// messages and the end, abort() included; signals to itself alone
		ALLOW_UP_TO(write, 0, OB_CALL_FD), // below it only standard error leads anywhere
		ALLOW_WITH(writev, 0, STDERR_FILENO), // glibc's message before abort()
		ALLOW(getpid),
		ALLOW(gettid),
		ALLOW(rt_sigaction),
		ALLOW(rt_sigprocmask),
		ALLOW(rt_sigreturn),
		ALLOW_WITH(tgkill, 0, self),
		ALLOW_WITH(kill, 0, self),
		ALLOW(exit),
		ALLOW(exit_group),
		RETURN(SECCOMP_RET_KILL_PROCESS),
	};
	return OB_SANITIZED || install(code, sizeof code / sizeof *code); // a sanitizer needs system calls of its own
}

// Keeps a process from others: it starts none, and sends none a signal.
static bool filter_others(void)
{
	const uint32_t self = (uint32_t)getpid();
	struct sock_filter code[] = {
		LOAD(arch),
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, MACHINE, 1, 0),
		RETURN(SECCOMP_RET_KILL_PROCESS),
		LOAD(nr),
#if defined(__x86_64__)
		BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1), // x32: the same calls by other numbers
		RETURN(SECCOMP_RET_KILL_PROCESS),
		REFUSE(fork, SECCOMP_RET_KILL_PROCESS),
		REFUSE(vfork, SECCOMP_RET_KILL_PROCESS),
#endif
		REFUSE(execve, SECCOMP_RET_KILL_PROCESS),
		REFUSE(execveat, SECCOMP_RET_KILL_PROCESS),
		REFUSE(ptrace, SECCOMP_RET_KILL_PROCESS),
		REFUSE(process_vm_writev, SECCOMP_RET_KILL_PROCESS),
		REFUSE(pidfd_send_signal, SECCOMP_RET_KILL_PROCESS),
		REFUSE(clone3, SECCOMP_RET_ERRNO | ENOSYS), // a filter cannot read its flags; glibc takes clone then
		ALLOW_WITH(kill, 0, self),
		ALLOW_WITH(tkill, 0, self),
		ALLOW_WITH(tgkill, 0, self),
		ALLOW_WITH(rt_sigqueueinfo, 0, self),
		ALLOW_WITH(rt_tgsigqueueinfo, 0, self),
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 3), // threads alone
		ARGUMENT(0),
		BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0),
		RETURN(SECCOMP_RET_KILL_PROCESS),
		RETURN(SECCOMP_RET_ALLOW),
	};
	return install(code, sizeof code / sizeof *code);
}
#else
static bool filter_system_calls(void)
{
	errno = ENOSYS;
	return false;
}

static bool filter_others(void)
{
	errno = ENOSYS;
	return false;
}
#endif

bool ob_confine_foreign(const ob_universe *u, ob_error *e)
{
	const bool drops = ob_universe_harden(u) & 1 << OB_HARDEN_PRIVILEGES;
	// after a change of user the library is found in /proc only by a process that may be dumped
	return (limit_memory() && (!drops || (drop_root() && prctl(PR_SET_DUMPABLE, 1) == 0)) && filter_others()) ||
	       ob_fail(e, "its process cannot be confined: %s", strerror(errno));
}

bool ob_confine_loaded(const ob_universe *u, ob_error *e)
{
	const uint32_t measures = ob_universe_harden(u);
	return ((!(measures & 1 << OB_HARDEN_PRIVILEGES) || prctl(PR_SET_DUMPABLE, 0) == 0) &&
		(!(measures & 1 << OB_HARDEN_LIMITS) || limit_resources()) &&
		(!(measures & 1 << OB_HARDEN_CALLS) || filter_system_calls())) ||
	       ob_fail(e, "its process cannot be confined: %s", strerror(errno));
}

bool ob_confine(ob_universe *u, uint32_t worker, ob_error *e)
{
	const uint32_t measures = ob_universe_harden(u);
	const bool arranges = ob_universe_contains(u) && worker == ob_universe_simulators(u);
	if (ob_universe_contains(u) && !arranges && !ob_outbox_enter(u, worker))
		return ob_fail(e, "cannot make the universe read-only: %s", strerror(errno));
	if (measures & 1 << OB_HARDEN_PAGES && !ob_desks_keep_own(u, worker))
		return ob_fail(e, "cannot leave the desks of others: %s", strerror(errno));
	if (measures & 1 << OB_HARDEN_PRIVILEGES && !drop_root())
		return ob_fail(e, "cannot give up privileges: %s", strerror(errno));
	if (measures & 1 << OB_HARDEN_LIMITS && !limit_resources())
		return ob_fail(e, "cannot limit resources: %s", strerror(errno));
	return !(measures & 1 << OB_HARDEN_CALLS) || filter_system_calls() ||
	       ob_fail(e, "cannot filter system calls: %s", strerror(errno));
}
