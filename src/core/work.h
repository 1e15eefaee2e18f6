/* Counts the work of this thread (rheo_work_done()). It has no influence on any result. */
#ifndef RHEO__WORK_H
#define RHEO__WORK_H

/* A step is begun. */
void rheo__work_step(void);
/* A whole state has been read. */
void rheo__work_state(void);

#endif
