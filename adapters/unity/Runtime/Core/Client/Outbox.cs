using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// The commands that wait to be sent: the game adds them, the worker takes them. A newer command drops waiting ones
    /// that it replaces: of each kind for one object only the newest waits, and `Put` and `Remove` replace all kinds. A
    /// command is also dropped when its time to live is over, or if it was written for another session.
    /// </summary>
    internal sealed class Outbox
    {
        private readonly object _lock = new object();
        private readonly WriterPool _writers;
        private readonly CommandsByObject _byObject;
        private readonly double _life;
        private Writer _hands, _quiet;
        private double _handsTime, _quietTime, _clearTime;
        private bool _clear;
        private int _session;

        /// <summary>writers: the pool of the parts. life: the time to live of a command [s].</summary>
        public Outbox(WriterPool writers, double life)
        {
            _writers = writers;
            _life = life;
            _byObject = new CommandsByObject(writers, life);
        }

        /// <summary>Starts a session without waiting commands. session: 0 for none.</summary>
        public void Open(int session)
        {
            lock (_lock)
            {
                Forget();
                _session = session;
            }
        }

        /// <summary>
        /// Adds a command about an object, and drops waiting ones that it replaces. part: its bytes, whose ownership
        /// passes.
        /// </summary>
        public bool Write(int session, Kind kind, string name, Writer part, ref Movement movement, double now)
        {
            lock (_lock)
            {
                bool current = Current(session, part);
                if (current)
                {
                    _byObject.Write(kind, name, part, ref movement, now);
                }
                return current;
            }
        }

        /// <summary>Replaces all hands, or all quiet zones. part: their bytes, whose ownership passes.</summary>
        public bool Write(int session, Kind kind, Writer part, double time)
        {
            lock (_lock)
            {
                if (!Current(session, part))
                {
                    return false;
                }
                if (kind == Kind.Hands)
                {
                    _writers.Return(_hands);
                    _hands = part;
                    _handsTime = time;
                }
                else
                {
                    _writers.Return(_quiet);
                    _quiet = part;
                    _quietTime = time;
                }
                return true;
            }
        }

        /// <summary>Drops all commands, and adds a clear.</summary>
        public bool Clear(int session, double now)
        {
            lock (_lock)
            {
                bool current = Current(session, null);
                if (current)
                {
                    Forget();
                    _clear = true;
                    _clearTime = now;
                }
                return current;
            }
        }

        /// <summary>Takes the next command, whose parts the caller returns. Returns false if none waits.</summary>
        public bool Take(CommandBatch batch, double now)
        {
            batch.Clear();
            lock (_lock)
            {
                if (_clear && now - _clearTime <= _life)
                {
                    batch.Begin(Kind.Clear, _clearTime);
                }
                _clear = false;
                Take(batch, Kind.Quiet, ref _quiet, _quietTime, now);
                _byObject.Take(batch, now);
                Take(batch, Kind.Hands, ref _hands, _handsTime, now);
            }
            return batch.Kind != Kind.None;
        }

        private void Take(CommandBatch batch, Kind kind, ref Writer part, double time, double now)
        {
            if (batch.Kind != Kind.None || part == null)
            {
                return;
            }
            if (now - time <= _life)
            {
                batch.Begin(kind, time);
                batch.Parts.Add(part);
            }
            else
            {
                _writers.Return(part);
            }
            part = null;
        }

        private bool Current(int session, Writer part)
        {
            if (session == 0 || session != _session)
            {
                _writers.Return(part);
                return false;
            }
            return true;
        }

        private void Forget()
        {
            _byObject.Forget();
            _writers.Return(_hands);
            _writers.Return(_quiet);
            _hands = _quiet = null;
            _clear = false;
        }
    }
}
