using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>The waiting commands about one object: the newest of each kind, and when it was written [s].</summary>
    internal sealed class ObjectCommands
    {
        private Writer _put, _envelope;
        private bool _removed, _moved;
        private double _removeTime, _putTime, _envelopeTime, _moveTime;

        public Movement Movement { get; private set; }

        /// <summary>Stores a command.</summary>
        public void Keep(Kind kind, Writer part, ref Movement movement, double now)
        {
            switch (kind)
            {
                case Kind.Remove: _removed = true; _removeTime = now; break;
                case Kind.Put: _put = part; _putTime = now; break;
                case Kind.Envelope: _envelope = part; _envelopeTime = now; break;
                case Kind.Move: _moved = true; Movement = movement; _moveTime = now; break;
            }
        }

        /// <summary>Whether no command waits.</summary>
        public bool Empty
        {
            get { return !_removed && !_moved && _put == null && _envelope == null; }
        }

        /// <summary>Returns whether a command of this kind waits.</summary>
        public bool Has(Kind kind)
        {
            switch (kind)
            {
                case Kind.Remove: return _removed;
                case Kind.Put: return _put != null;
                case Kind.Envelope: return _envelope != null;
                case Kind.Move: return _moved;
                default: return false;
            }
        }

        /// <summary>Returns when the command of this kind was written [s].</summary>
        public double Time(Kind kind)
        {
            switch (kind)
            {
                case Kind.Remove: return _removeTime;
                case Kind.Put: return _putTime;
                case Kind.Envelope: return _envelopeTime;
                default: return _moveTime;
            }
        }

        /// <summary>Returns the bytes of the command of this kind; null if it has none.</summary>
        public Writer Part(Kind kind)
        {
            return kind == Kind.Put ? _put : kind == Kind.Envelope ? _envelope : null;
        }

        /// <summary>Drops the command of this kind.</summary>
        public void Drop(Kind kind)
        {
            switch (kind)
            {
                case Kind.Remove: _removed = false; break;
                case Kind.Put: _put = null; break;
                case Kind.Envelope: _envelope = null; break;
                case Kind.Move: _moved = false; break;
            }
        }
    }
}
