// Rank of this process in the environment variables of Open MPI 4.1.4 and Slurm 22.05.
#include "check.h"

#include <stdbool.h>
#include <stdlib.h>

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

int main(void)
{
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
