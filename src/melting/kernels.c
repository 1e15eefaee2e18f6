/* A loop of its own over the kernels of pairs, for worlds that cannot find them in stage momentum (kernels.h). */
#include "melting/kernels.h"

void RHEO__VARIANT(find_kernels)(rheo__melting *m)
{
    rheo__kernels kernels = rheo__kernels_begin(m);
    RHEO__EACH_VECTOR_OF_ROWS(&m->rows, block, first)
    {
        const rheo__lanes3 position = rheo__lanes_load_wide_row(m->point + block * RHEO__BLOCK_ROWS + first).at;
        rheo__pair_counts counts = {0};
        RHEO__EACH_ENTRY(&m->rows, block, first, entry)
        {
            const rheo__lanes3 x = rheo__offsets(m, position, entry);
            const rheo__lanes r2 = rheo__lanes3_dot(x, x);
            rheo__put_kernel(&m->rows, &kernels, entry, r2);
            rheo__count_pairs(&counts, &kernels, r2);
        }
        rheo__add_counts(&kernels, counts);
    }
    rheo__kernels_end(m, &kernels);
}
