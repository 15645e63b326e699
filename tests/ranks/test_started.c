// Rank of this process in the environment variables of Open MPI 4.1.4 and Slurm 22.05, and a start that is late.
#include "check.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ranks/ranks.h"

static const char *const all[] = { "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "PMIX_RANK",
				   "SLURM_NTASKS",         "SLURM_PROCID",         "SLURM_STEP_NUM_TASKS" };
enum { WORDS = sizeof all / sizeof *all };

// said: value of each of these variables; NULL: unset
static bool is_started(const char *const said[WORDS], uint32_t rank, uint32_t ranks)
{
	for (int i = 0; i < WORDS; i++)
		if (said[i])
			setenv(all[i], said[i], 1);
		else
			unsetenv(all[i]);
	const ob_ranks found = ob_ranks_started();
	return found.rank == rank && found.ranks == ranks;
}

// A process that waits for other ranks ends with one line; ranks behind the first wait longer; one that has started
// goes on.
static void check_late(void)
{
	char line[400] = "";
	int ends[2], status;
	CHECK(pipe(ends) == 0);
	const pid_t child = fork();
	if (child == 0) {
		dup2(ends[1], STDERR_FILENO);
		ob_ranks_limit_start(1, 0);
		for (;;)
			pause();
	}
	close(ends[1]);
	CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 1);
	CHECK(read(ends[0], line, sizeof line - 1) > 0 && strstr(line, "rank 0 has waited 1 s"));
	CHECK(strchr(line, '\n') == line + strlen(line) - 1);
	close(ends[0]);
	ob_ranks_limit_start(1000, 500);
	CHECK(alarm(0) > 1000);
	ob_ranks_limit_start(1000, 500);
	ob_ranks_limit_start(0, 500);
	CHECK(alarm(0) == 0);
}

int main(void)
{
	check_late();
	CHECK(is_started((const char *[WORDS]){ 0 }, 0, 1));
	CHECK(is_started((const char *[WORDS]){ "2", "4", "2" }, 2, 4)); // mpirun
	CHECK(is_started((const char *[WORDS]){ "0", "1", "0" }, 0, 1));
	CHECK(is_started((const char *[WORDS]){ "2", "4", "2", "2", "1", "2" }, 2,
			 4)); // mpirun, whose daemons srun has started
	CHECK(is_started((const char *[WORDS]){ NULL, NULL, "1", "2", "1", "2" }, 1, 2)); // srun --mpi=pmix
	CHECK(is_started((const char *[WORDS]){ NULL, NULL, NULL, "2", "1", "2" }, 0,
			 1)); // srun --mpi=none: each alone
	CHECK(is_started((const char *[WORDS]){ NULL, NULL, NULL, "2", "0", NULL }, 0, 1)); // the script of a batch job
	CHECK(is_started((const char *[WORDS]){ "4", "4" }, 0, 1)); // inconsistent
	CHECK(is_started((const char *[WORDS]){ "2", "4", "2", "2", "1", "2" }, 2, 4));
	ob_ranks_forget();
	const ob_ranks alone = ob_ranks_started();
	CHECK(alone.rank == 0 && alone.ranks == 1);
	return check_end();
}
