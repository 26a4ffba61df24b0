"""Child processes, their messages and shared memory.

::

    window process                                      solver process           factor process (large meshes)
    thread "solver": SolverWorker   -- request, arrays -> thread "requests": Mailbox
    thread "answers": SolverProcess <- reply, shape ----- RequestSolver, Deformation
                                                          RemoteFactor -- matrix, B -> LinearSolver
                                                                       <- solution ---
    thread "shape check"            -- F, U ------------> shape-check process (ipctk)
                                    <- ShapeCheck ------
    thread "geodesic"               -- F, U, ends ------> geodesic process (potpourri3d)
                                    <- path -------------

Every process is a :class:`ChildProcess`: messages by two pipes, large arrays beside them in shared memory.
It ends with its parent process and ignores Ctrl+C; if it fails, the log gets the last lines of its standard
error.
"""
