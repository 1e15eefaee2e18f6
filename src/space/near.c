/* Tests of RHEO__LANES particles at a time (space/near.h). */
#include "space/near.h"

#include "core/lane_points.h"

uint64_t RHEO__VARIANT(near)(const rheo_real *position, uint32_t count, const rheo_real centre[3], rheo_real reach2)
{
    uint64_t near = 0;
    uint32_t i = 0;
    for (; i + RHEO__LANES <= count; i += RHEO__LANES) {
        const rheo__lanes3 x = rheo__lanes_load_triples(position + 3 * (size_t)i);
        const rheo__lanes dx = x.x - centre[0], dy = x.y - centre[1], dz = x.z - centre[2];
        const rheo__mask mask = dx * dx + dy * dy + dz * dz < rheo__lanes_all(reach2);
        if (rheo__lanes_any(mask))
            for (uint32_t lane = 0; lane < RHEO__LANES; lane++)
                near |= (uint64_t)(RHEO__LANE(mask, lane) != 0) << (i + lane);
    }
    for (; i < count; i++) {
        const rheo_real *x = position + 3 * (size_t)i;
        near |= (uint64_t)(rheo__length2(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]) < reach2) << i;
    }
    return near;
}
